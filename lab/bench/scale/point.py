# SPDX-License-Identifier: Apache-2.0
"""The engine's side of one point of `python -m lab scale`, a process of its own: the peak of its memory is the point's.

    python -m lab.bench.scale.point SIZE JOB …

It loads the job folders, draws each at SIZE x SIZE, takes a step, searches for a round without anchors, and prints a line of
JSON: phase to `processor` seconds, `wall` seconds and `memory`, MB over what the process had before. It has one thread: threads
that wait for others count as work, most on a busy machine.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import torch
from torch import Tensor

from proxy_renderer.engine.worker import keep_freed_memory
from proxy_renderer.guidance.encoder import load_encoder
from proxy_renderer.optimize import pipeline
from proxy_renderer.optimize.looks import EarlyLook
from proxy_renderer.optimize.rounds.search import Search
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.optimize.stage import set_stage
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import SceneData, load_scene
from proxy_renderer.schema.messages import Anchor, Anchored, Options, Progress

_PROMPT = "warm light"
_LEARNED = ("material/Stuff 0/base_color", "material/Stuff 0/roughness", "light/Lamp 0/power", "light/Lamp 0/color")
_EVERYWHERE = ("world/color", "film/exposure", "film/contrast")
_STEPS = 3


class CostMeter:
    """Costs by phase.

    Attributes:
        costs: Phase to `processor`, `wall` and `memory`.
    """

    def __init__(self) -> None:
        self.costs: dict[str, dict[str, float]] = {}
        self._before = _peak()

    @contextmanager
    def phase(self, name: str, times: int = 1) -> Iterator[None]:
        """Measures what is done inside, by turn if it is done several times."""
        processor, wall = time.process_time(), time.monotonic()
        yield
        spent = time.process_time() - processor, time.monotonic() - wall
        self.costs[name] = {
            "processor": round(spent[0] / times, 4),
            "wall": round(spent[1] / times, 4),
            "memory": round(_peak() - self._before, 1),
        }


class _Follower:
    """Follows the search, and says nothing."""

    wants_looks = False

    def stage(self, name: str) -> None:
        """Nothing."""

    def begin(self, display: Tensor, lit: bool) -> None:
        """Nothing."""

    def look(self, look: EarlyLook) -> None:
        """Nothing."""

    def step(self, progress: Progress, display: Tensor) -> bool:
        """Goes on."""
        return False

    def stopped(self) -> bool:
        """Goes on."""
        return False

    def ask(self, request: Anchor) -> Anchored:
        """There is no Blender."""
        raise AssertionError("a search without anchors asks for none")


def measure(jobs: Sequence[Path], size: int) -> dict[str, dict[str, float]]:
    """The costs of each phase.

    Args:
        jobs: Job folders of shots that share a look.
        size: Side of the pictures, pixels.
    """
    torch.set_num_threads(1)
    keep_freed_memory()  # as the engine's worker does
    encoder, watch = load_encoder(None), CostMeter()
    with watch.phase("load"):
        scenes = [load_scene(job) for job in jobs]
    with watch.phase("first draw"), torch.no_grad():
        proxies = [Proxy(scene, (size, size)) for scene in scenes]
        for proxy in proxies:
            proxy.render({})
    values = _values(scenes[0])
    _step(proxies, values)  # the first one makes what later ones find
    with watch.phase("step", _STEPS):
        for _ in range(_STEPS):
            _step(proxies, values)
    del proxies
    options = Options(rounds=1, steps=1, starts=1, anchor=False)
    with watch.phase("search"):
        stage = set_stage(scenes, _PROMPT)
        views = [ShotInput(scene) for scene in stage.scenes]
        pipeline.run(Search(views, stage, options, encoder, _Follower()))
    return watch.costs


def _values(scene: SceneData) -> dict[str, Tensor]:
    """Eight values or fewer, as a round learns them."""
    keys = [key for key in (*_LEARNED, *_EVERYWHERE) if key in scene.instances]
    return {key: torch.tensor(scene.instances[key].value, requires_grad=True) for key in keys}


def _step(proxies: Sequence[Proxy], values: dict[str, Tensor]) -> None:
    for proxy in proxies:
        picture = proxy.render(values).display
        picture.backward(torch.full_like(picture, 1e-6))


def _peak() -> float:
    """The most memory that this process has had, MB."""
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return most / 2**20 if sys.platform == "darwin" else most / 2**10


if __name__ == "__main__":
    print(json.dumps(measure([Path(job) for job in sys.argv[2:]], int(sys.argv[1]))))
