# SPDX-License-Identifier: Apache-2.0
"""A `Worker` in a process of a cluster's node, which may see the results folder or not."""

from __future__ import annotations

import os
import tempfile
from dataclasses import replace
from pathlib import Path

from .plan import Job
from .store import TOKEN, JobRow, read_json
from .worker import Interrupted, Setup, Worker


class Station:
    """A worker in an actor's process.

    Args:
        out: Where the results folder is on the head.
        token: Its name: this machine sees the same folder if it finds it there.
    """

    def __init__(self, setup: Setup, out: Path, token: str) -> None:
        self._worker = Worker(setup)
        self._jobs = out / "jobs"
        self._shares = (read_json(out / TOKEN) or {}).get("token") == token
        self._node = os.getppid()  # the node's own process has started this one

    def shares(self) -> bool:
        """Whether this machine sees the results folder."""
        return self._shares

    def run(self, job: Job, *scenes: bytes) -> tuple[JobRow, dict[str, bytes]]:
        """Carries out a job; its files are returned where they could not be put into the results folder.

        Args:
            scenes: What is in its scenes' files, if this machine does not see them.

        Raises:
            Interrupted: The node has died. Ray kills this process's Blender before the process itself, and that must
                not pass for a failure of the job.
        """
        row, files = self._carry_out(job, *scenes)
        if row["status"] == "failed" and os.getppid() != self._node:
            raise Interrupted
        return row, files

    def _carry_out(self, job: Job, *scenes: bytes) -> tuple[JobRow, dict[str, bytes]]:
        if self._shares:
            return self._worker.run(job, self._jobs / job.name), {}
        with tempfile.TemporaryDirectory(prefix="vibe-batch-") as place:
            folder = Path(place) / "out"
            sources = [_put(Path(place) / str(i), job, i, content) for i, content in enumerate(scenes)]
            row = self._worker.run(replace(job, source=sources[0], more=tuple(sources[1:])), folder)
            files = [p for p in folder.rglob("*") if p.is_file() and not p.name.startswith(".")]
            return row, {p.relative_to(folder).as_posix(): p.read_bytes() for p in files}

    def close(self) -> None:
        """Ends the running job."""
        self._worker.close()


def _put(folder: Path, job: Job, number: int, content: bytes) -> Path:
    """A scene that has been sent, under its own name."""
    path = folder / (job.source, *job.more)[number].name
    path.parent.mkdir()
    path.write_bytes(content)
    return path
