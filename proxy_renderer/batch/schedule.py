# SPDX-License-Identifier: Apache-2.0
"""Hands out jobs until all are done or given up: the same on one machine and on a cluster."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Callable, Iterator

from .local import Pool
from .manifest.manifest import Limits
from .plan import Job, Jobs
from .store import JobRow, Store, head

_LOSSES = 5
"""Times that a worker may be lost in a job before the job is blamed for it."""


def run(
    plan: Jobs,
    store: Store,
    pool: Pool,
    limits: Limits,
    tell: Callable[[str, Job, JobRow], None],
    finished: bytearray | None = None,
) -> None:
    """Carries out the jobs that are not done yet. Jobs are made only when there is a worker for them.

    Args:
        limits: How often a failed job is tried again, and how much disk space must be free.
        tell: Hears of "started", "done", "again", "lost" and "failed" jobs.
        finished: Which jobs are done, if that has been looked up; see `Store.finished`.

    Raises:
        VibeError: Nothing can be written any more.
    """
    finished = store.finished(plan) if finished is None else finished
    fresh: Iterator[Job] = (job for job, done in zip(plan, finished, strict=True) if not done)
    again: deque[Job] = deque()
    attempts: Counter[str] = Counter()
    losses: Counter[str] = Counter()
    out, exhausted = 0, False
    while True:
        while out < pool.capacity():
            job = None if exhausted else next(fresh, None)
            exhausted = job is None
            if job is None and again:
                job = again.popleft()
            if job is None:
                break
            store.check_space(limits.free_gb)
            pool.submit(job)
            tell("started", job, {})
            out += 1
        if exhausted and not again and not out:
            return
        for job, row in pool.wait(1.0):
            out -= 1
            if row is None:
                losses[job.name] += 1
                if losses[job.name] <= _LOSSES:
                    again.append(job)
                    tell("lost", job, {})
                    continue
                row = _lost(job)
            attempts[job.name] += 1
            row["attempts"] = attempts[job.name]
            if row["status"] == "done":
                del attempts[job.name]
                tell("done", job, row)
                continue
            store.fail(job, row)
            if attempts[job.name] <= limits.retries:
                again.append(job)
                tell("again", job, row)
            else:
                tell("failed", job, row)


def _lost(job: Job) -> JobRow:
    message = f"The machine that worked on it was lost {_LOSSES + 1} times."
    return head(job) | {
        "status": "failed",
        "error": message,
        "remedy": "Give it more memory: [limits] memory_gb.",
    }
