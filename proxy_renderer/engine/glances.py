# SPDX-License-Identifier: Apache-2.0
"""Glances: what the plan alone gives for words that are still being typed, on a scene that is loaded once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ..guidance.encoder import load_encoder
from ..optimize import context
from ..optimize.looks import EarlyLook, Looks
from ..optimize.progress import BEFORE
from ..optimize.shots import ShotInput, gathered
from ..planning.advice import OfflineAdvisor
from ..render.proxy import Proxy
from ..scene import SceneData, load_scene
from ..schema import VibeError, messages
from . import report
from .additions import with_additions
from .device import pick_device


class Glances:
    """Answers glances at one job after another.

    A scene is loaded once, and its proxies stay: one for each set of lights and backdrops that words have asked for.
    """

    def __init__(self) -> None:
        self._job = ""
        self._found: SceneData | None = None
        self._proxies: dict[tuple[str, ...], Proxy] = {}

    def look(self, request: messages.Glance, stopped: Callable[[], bool]) -> EarlyLook | None:
        """The look of a glance; a picture of the artist's own values is left beside it.

        Args:
            request: The words, and the job folder.
            stopped: Whether nobody wants it any more; asked between the parts that take long.

        Returns:
            None if it was stopped, or no word is known yet.

        Raises:
            VibeError: The job cannot be read.
        """
        options = messages.Options.from_dict(request.options)
        addition = with_additions(
            [self._scene(request.job)], request.prompt, options.new_lights, options.target
        )
        (scene,) = addition.scenes
        _, (shot,) = gathered([ShotInput(scene)], options, lambda _: self._proxy(scene, options))
        if stopped():
            return None
        looks = Looks(shot, addition.understood.scene)
        advisor = OfflineAdvisor(addition.goals, addition.plan)
        report.save_picture(looks.before.display, Path(request.job) / BEFORE)
        try:
            u, advice = looks.planned(advisor)
        except VibeError:  # half a word, perhaps
            return None
        return None if stopped() else looks.drawn(u, addition.claims(advice.goals))

    def _scene(self, job: str) -> SceneData:
        if self._found is None or job != self._job:
            self._job, self._found = job, load_scene(Path(job))
            self._proxies.clear()
        return self._found

    def _proxy(self, scene: SceneData, options: messages.Options) -> Proxy:
        added = tuple(scene.instances)
        if added not in self._proxies:
            device = pick_device(options.device)
            size = context.inner_size(scene, options, load_encoder(options.encoder or None, device))
            self._proxies[added] = Proxy(scene, size, device, options.seed)
        return self._proxies[added]
