# SPDX-License-Identifier: Apache-2.0
"""Answers while the artist types: the reading of each word, and a first look (values from the words alone)."""

import contextlib
import functools
from collections.abc import Callable, Sequence
from pathlib import Path

from ..guidance.encoder import load_encoder
from ..optimize.looks import EarlyLook, Looks
from ..optimize.progress import BEFORE
from ..optimize.scene_facts import described
from ..optimize.shots import ShotInput, gathered, inner_size
from ..optimize.stage import linked, set_stage
from ..render.proxy import Proxy
from ..scene import SceneData, load_scene
from ..schema import VibeError, messages
from ..schema.targets import GENERAL, NOT_USED, listed
from ..words.lexicon.languages import Nearest
from ..words.lexicon.vocabulary import default_vocabulary
from ..words.parser import Understood
from ..words.types import LightDescription, SceneDescription
from .pictures import save_picture
from .session import pick_device


def answer(request: messages.AskReadings) -> messages.Readings:
    """Readings of a prompt's words, as a vibe would understand them; raises VibeError for an unreadable job folder."""
    # Without a job only names are known, and all objects count as the subject.
    objects = request.objects
    scene = SceneDescription(
        objects=dict.fromkeys(objects, "subject"),
        materials=dict.fromkeys((m for names in objects.values() for m in names), "subject"),
        object_materials={name: tuple(materials) for name, materials in objects.items()},
        lights={name: LightDescription(kind) for name, kind in request.lights.items()},
    )
    if request.job:
        with contextlib.suppress(OSError):  # live mode has ended, the folder is gone: the panel asks again
            scene = _described(request.job, (Path(request.job) / "scene.json").stat().st_mtime_ns)
    return readings(request.prompt, scene, request.target)


@functools.lru_cache(maxsize=1)
def _described(job: str, written: int) -> SceneDescription:
    """The description of the scene in folder `job`; `written`: time of its scene.json, so that a new one is read."""
    return described(load_scene(job))


def readings(prompt: str, scene: SceneDescription, target: Sequence[str] = ()) -> messages.Readings:
    """Readings of a prompt's words, as a vibe would understand them; `target`: the artist's choices, "copper=Cup"."""
    if not prompt.strip():
        return messages.Readings(prompt)
    understood = Understood(prompt, scene, target)
    note = str(understood.unknown or "")
    if not understood.words:  # so that the artist can click on the word whose target is impossible
        understood = Understood(prompt, scene)
    words = []
    for word in understood.words:
        is_general = word.target in GENERAL and word.thing not in word.target
        describes = f"describes {listed(word.target)}" + (f" ({word.thing})" if is_general else "")
        state, meaning, others = "understood", describes, []
        if word.target == NOT_USED:
            state, meaning = "left out", word.target
            if not word.candidates:  # two known words to choose in its place
                others = default_vocabulary().made(Nearest).choices(word.text, 2)
        elif word.guess:
            state, meaning = "guessed", f"taken for “{word.guess}”, {describes}"
        candidates = [candidate.name for candidate in word.candidates]
        words.append(messages.WordReading(word.text, state, meaning, others, word.key, candidates, [*word.others]))
    return messages.Readings(prompt, words, note)


class Glances:
    """Answers requests for a first look. The last job's scene stays loaded, with a proxy for each set of parameters."""

    def __init__(self) -> None:
        self._job = ""
        self._found: SceneData | None = None
        self._proxies: dict[tuple[str, ...], Proxy] = {}

    def look(self, request: messages.Glance, stopped: Callable[[], bool]) -> EarlyLook | None:
        """A quick result before the search; None if `stopped` returns True, or if the prompt has no known word.

        Raises VibeError if the job folder cannot be read.
        """
        options = messages.Options.from_dict(request.options)
        if self._found is None or request.job != self._job:
            self._job, self._found = request.job, load_scene(Path(request.job))
            self._proxies.clear()
        stage = linked(set_stage([self._found], request.prompt, options.new_lights, options.target), options)
        (scene,) = stage.scenes
        _, (shot,) = gathered([ShotInput(scene)], options, lambda _: self._proxy(scene, options))
        if stopped():
            return None
        looks = Looks(shot, stage.understood.scene)
        save_picture(looks.before, Path(request.job) / BEFORE)
        try:
            u, advice = looks.planned(stage.advisor)
        except VibeError:  # no word is known: it may be half typed
            return None
        return None if stopped() else looks.drawn(u, stage.claims(advice.goals))

    def _proxy(self, scene: SceneData, options: messages.Options) -> Proxy:
        parameters = (*scene.instances, *scene.links)
        if parameters not in self._proxies:
            encoder = load_encoder(options.encoder or None, pick_device(options.device))
            size = inner_size(scene, options, encoder, bool(options.like))
            self._proxies[parameters] = Proxy(scene, size, str(encoder.device), options.seed)
        return self._proxies[parameters]
