# SPDX-License-Identifier: Apache-2.0
"""The work of a batch and an estimate of its time: `vibe batch --dry-run`."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from .plan import BatchPlan, Job
from .progress import duration
from .store import DONE, FAILED, read_json

_LISTED = 12
_MEASURED = 50  # finished jobs that an estimate looks at

# Seconds on two cores at 512 pixels and 128 samples, from `vibe demo`: see "Speed" in the README.
_FIXED, _ROUND, _STEP, _RENDERS = 5.0, 3.0, 0.14, 12.0


def account(plan: BatchPlan, out: Path, workers: int) -> str:
    """The plan as text.

    Args:
        out: The results folder; it need not exist.
        workers: Jobs at a time; 0 if a cluster decides.
    """
    counts = {True: 0, False: 0}
    scenes: Counter[str] = Counter()
    seconds: list[float] = []
    guessed, failed = 0.0, 0
    for job in plan:
        folder = out / "jobs" / job.name
        done = (folder / DONE).is_file()
        counts[done] += 1
        scenes[job.scene] += 1
        failed += not done and (folder / FAILED).is_file()
        if done and len(seconds) < _MEASURED:
            seconds.append((read_json(folder / DONE) or {}).get("seconds", 0.0))
        if not done:
            guessed += guess(job)
    to_do = counts[False]
    lines = [
        f"{len(plan)} jobs: {counts[True]} done, {to_do} to do"
        + (f", of which {failed} had failed." * bool(failed) or ".")
    ]
    lines += [f"  {count:5}  {scene}" for scene, count in list(scenes.items())[:_LISTED]]
    lines += [f"         ... and {len(scenes) - _LISTED} more scenes"] if len(scenes) > _LISTED else []
    if not to_do:
        return "\n".join(lines)
    each = sum(seconds) / len(seconds) if seconds else guessed / to_do
    basis = f"as the {len(seconds)} looked at took" if seconds else "a guess, until jobs have been measured"
    where = f"with {workers} worker{'s' * (workers != 1)}" if workers else "divided by the cluster's workers"
    total = each * to_do / max(workers, 1)
    lines.append(f"About {duration(each)} a job ({basis}): {duration(total)} {where}.")
    return "\n".join(lines)


def guess(job: Job) -> float:
    """Seconds that a job would take on two cores."""
    options = dict(a[2:].split("=", 1) for a in job.arguments if "=" in a)
    rounds, steps = int(options["rounds"]), int(options["steps"])
    pictures = (int(options["size"]) / 512) ** 2 * int(options["samples"]) / 128
    cameras = sum(a.startswith("--cameras=") for a in job.arguments)
    frames = 1 + options.get("frames", "").count(",")
    shots = (1 + len(job.more)) * max(cameras, 1) * frames
    # Steps take the shots in turn; anchors and final pictures are made of each.
    return _FIXED + rounds * (_ROUND * shots + steps * _STEP) + _RENDERS * pictures * shots
