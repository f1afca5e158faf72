# SPDX-License-Identifier: Apache-2.0
"""The final frames: `vibe batch --final` renders them after the vibes, by the same workers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from .plan import Job, Jobs
from .store import Store


class Finals:
    """A job for the final frames of every result that is there.

    Frames that have been rendered stay when a job is tried again, so that a time limit costs one frame at most.

    Args:
        plan: The vibes.
        store: Where their results are.
        frames: "1-24", or "" for the scene's own.
    """

    def __init__(self, plan: Jobs, store: Store, frames: str) -> None:
        self._plan, self._store, self._frames = plan, store, frames

    def __len__(self) -> int:
        return self._store.count(self._plan)

    def __iter__(self) -> Iterator[Job]:
        for job in filter(self._store.done, self._plan):
            first, *more = results(self._store.jobs / job.name)
            yield replace(job, source=first, more=tuple(more), frames=self._frames)


def results(folder: Path) -> list[Path]:
    """The .blends that a vibe has left: one, or one for each scene of several."""
    numbers = (path.stem.removeprefix("vibed-") for path in folder.glob("vibed-*.blend"))
    rest = sorted(int(number) for number in numbers if number.isdecimal())
    return [folder / "vibed.blend", *(folder / f"vibed-{number}.blend" for number in rest)]
