# SPDX-License-Identifier: Apache-2.0
"""The final frames: `vibe batch --final` renders them after the vibes, by the same workers."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from .plan import Job, Jobs, Take
from .store import Store, read_json


class Finals:
    """A job for the final frames of every finished result.

    Frames that have been rendered stay when a job is tried again, so that a time limit costs one frame at most.

    Args:
        frames: "1-24"; or "" for those that the look was made for, else the scene's own.
    """

    def __init__(self, plan: Jobs, store: Store, frames: str) -> None:
        self._plan, self._store, self._frames = plan, store, frames

    def __len__(self) -> int:
        return sum(self._store.finished(self._plan))

    def __iter__(self) -> Iterator[Job]:
        for job in filter(self._store.done, self._plan):
            folder = self._store.jobs / job.name
            shots = (read_json(folder / "report.json") or {}).get("shots", [])
            blends = list(dict.fromkeys(shot["blend"] for shot in shots)) or ["vibed.blend"]
            first, *more = (folder / name for name in blends)
            takes_of_job = takes(shots, blends, self._frames)
            yield replace(job, source=first, more=tuple(more), frames=self._frames, takes=takes_of_job)


def takes(shots: list[dict[str, Any]], blends: list[str], frames: str) -> tuple[Take, ...]:
    """The renders of a vibe's shots: each .blend through each of its cameras, once."""
    if not shots:
        return (Take(0, frames=frames),)
    grouped: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for shot in shots:
        grouped.setdefault((shot["blend"], shot["camera"]), []).append(shot)
    keys = ("scene", "camera") if len({shot["scene"] for shot in shots}) > 1 else ("camera",)
    labels = [_label(*(some[0][key] for key in keys)) for some in grouped.values()]
    grouped_takes = []
    for ((blend, camera), some), label in zip(grouped.items(), labels, strict=True):
        own = [str(shot["frame"]) for shot in some if shot["frame"] is not None]
        if labels.count(label) > 1:  # each frame has a grade, and so a .blend, of its own
            label = _label(label, *own[:1])
        folder = label if len(grouped) > 1 else ""
        grouped_takes.append(Take(blends.index(blend), camera, frames or ",".join(own), folder))
    return tuple(grouped_takes)


def _label(*parts: str) -> str:
    """Scene and camera as the name of a folder."""
    return "-".join(re.sub(r"[^\w.-]+", "_", part) for part in parts if part)
