# SPDX-License-Identifier: Apache-2.0
"""`vibe batch`, from a manifest to a folder of results, and `vibe flamenco install`."""

import argparse
import json
import os
import re
import signal
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from datetime import timedelta
from itertools import islice
from pathlib import Path
from statistics import mean

from rich.progress import BarColumn, TimeElapsedColumn, TimeRemainingColumn

from ..blender.launch import TerminalBar, blender_side, handling
from ..schema import VibeError
from ..words.lexicon.vocabulary import VARIABLE
from . import manifest
from .manifest import BatchPlan, Job, Limits
from .pools import Pool, RayPool, fitting, local_pool, machine
from .store import DONE, FAILED, Finals, JobRow, Sheet, Store, head, read_json, write_bytes
from .worker import Setup

_LISTED = 12  # most scenes that the plan lists
_MEASURED = 50  # most finished jobs whose times an estimate uses
# Seconds on two cores, from `vibe demo` (see "Speed" in the README): the start, a round's anchor of a shot, a step, and
# the final renders of a shot at 512 pixels and 128 samples.
_FIXED, _ROUND, _STEP, _RENDERS = 5.0, 3.0, 0.14, 12.0
_LOSSES = 5  # times that a job's worker may be lost before the job counts as failed
Tell = Callable[[str, Job, JobRow], None]  # is called with "started", "done", "failed", "again" or "lost"


class BatchProgress(TerminalBar):
    """A progress bar that counts jobs; `total` and `done` are numbers of jobs at the start."""

    def __init__(self, total: int, done: int) -> None:
        self._total, self._before, self._ended = total, done, done
        self.counts = {"done": done, "failed": 0, "running": 0}
        jobs, bar = "{task.completed:.0f}/{task.total:.0f} jobs", BarColumn(bar_width=32)
        columns = (jobs, bar, "{task.description}", TimeElapsedColumn(), TimeRemainingColumn())
        super().__init__(columns, None, False, description="", total=total, completed=done)

    def tell(self, what: str, job: Job, row: JobRow) -> None:
        """Counts and shows a job that is "started", "done", "failed", "again" (tried again) or "lost"."""
        self.counts["running"] += 1 if what == "started" else -1
        if what in ("done", "failed"):
            self.counts[what] += 1
            self._ended += 1
        failed = f", {self.counts['failed']} failed" if self.counts["failed"] else ""
        self.update(self._task, description=f"{self.counts['running']} running{failed}", completed=self._ended)
        if what == "started" or not (what == "failed" or self._plain):
            return
        if what == "done" and job.frames is not None:
            how = f"{row['seconds']:.0f} s, {row['frames']} frames"
        elif what == "done":
            how = f"{row['seconds']:.0f} s, delta E {row['delta_e']:.1f}"
        elif what == "lost":
            how = "its machine is lost; it will be done elsewhere"
        else:
            how = f"{row['error']}{' It will be tried again.' if what == 'again' else ''}"
        who = f"{job.scene} · {job.prompt} · {job.seed}"
        self.note(f"[{self._ended}/{self._total}] {what:6} {who}: {how}")

    def summary(self) -> str:
        """The outcome in one line."""
        seconds = time.monotonic() - self._start
        new = self.counts["done"] - self._before
        waiting = self._total - self._ended
        parts = [f"{self.counts['done']} of {self._total} jobs are done ({new} now, in {_clock(seconds)})"]
        parts += [f"{self.counts['failed']} failed"] if self.counts["failed"] else []
        parts += [f"{waiting} wait"] if waiting else []
        return ", ".join(parts) + "."


def _clock(seconds: float) -> timedelta:
    return timedelta(seconds=round(seconds))


def account(plan: BatchPlan, out: Path, workers: int) -> str:
    """The plan as text: jobs done and to do, jobs by scene, and the estimated time; `workers` is 0 for a cluster."""
    scenes = Counter(job.scene for job in plan)
    folders = {job.name: out / "jobs" / job.name for job in plan}
    to_do = [job for job in plan if not (folders[job.name] / DONE).is_file()]
    failed = sum((folders[job.name] / FAILED).is_file() for job in to_do)
    before = f", of which {failed} had failed" if failed else ""
    lines = [f"{len(plan)} jobs: {len(plan) - len(to_do)} done, {len(to_do)} to do{before}."]
    lines += [f"  {count:5}  {scene}" for scene, count in list(scenes.items())[:_LISTED]]
    lines += [f"         ... and {len(scenes) - _LISTED} more scenes"] if len(scenes) > _LISTED else []
    if not to_do:
        return "\n".join(lines)
    # The times of finished jobs predict those of the others; without finished jobs, `guess` does.
    rows = filter(None, (read_json(folder / DONE) for folder in folders.values()))
    seconds = [row["seconds"] for row in islice(rows, _MEASURED)]
    each = mean(seconds or map(guess, to_do))
    basis = f"as the {len(seconds)} looked at took" if seconds else "a guess, until jobs have been measured"
    where = f"with {workers} worker{'s' * (workers != 1)}" if workers else "divided by the cluster's workers"
    lines.append(f"About {_clock(each)} a job ({basis}): {_clock(each * len(to_do) / max(workers, 1))} {where}.")
    return "\n".join(lines)


def guess(job: Job) -> float:
    """Seconds that a job would take on two cores."""
    options = dict(a[2:].split("=", 1) for a in job.arguments if "=" in a)
    rounds, steps = int(options["rounds"]), int(options["steps"])
    pictures = (int(options["size"]) / 512) ** 2 * int(options["samples"]) / 128
    cameras = sum(a.startswith("--cameras=") for a in job.arguments)
    shots = (1 + len(job.more)) * max(cameras, 1) * (1 + options.get("frames", "").count(","))
    # A step draws one of the shots, in turn; anchors and final renders are made of every shot.
    return _FIXED + rounds * (_ROUND * shots + steps * _STEP) + _RENDERS * pictures * shots


def run(a: argparse.Namespace) -> int:
    """Carries out the command; returns 0, or 1 if jobs have failed. Another run continues with the jobs not done."""
    plan, limits = manifest.load(a.manifest, a.out)
    if a.workers < 0:
        raise VibeError(f"--workers {a.workers} is out of range.", "Use 1 or more, or leave it out.")
    if a.final and not re.fullmatch(r"\d+(-\d+)?", a.final):
        raise VibeError(f"--final {a.final} names no frames.", "Write them as in --final 1-24.")
    if a.dry_run:
        print(account(plan, a.out, 0 if a.ray else a.workers or fitting(machine(), limits) or 1))
        return 0
    setup = Setup(limits, {VARIABLE: os.environ[VARIABLE]} if VARIABLE in os.environ else {})
    with Store(a.out) as store, handling(signal.default_int_handler, signal.SIGTERM):
        store.check_space(limits.free_gb)
        sheet = Sheet(a.manifest.stem, plan, store)
        sheet.write()
        print(f"{len(plan)} jobs. Watch {store.folder / 'index.html'}", flush=True)
        pool: Pool = RayPool(a.ray, store, setup, a.workers) if a.ray else local_pool(store.jobs, setup, a.workers)
        try:
            failed = _pass(plan, store, pool, limits, sheet)
            if a.final is not None:
                failed += _pass(Finals(plan, store, a.final), store, pool, limits, sheet)
        finally:
            with handling(signal.SIG_IGN, signal.SIGINT, signal.SIGTERM):  # nothing interrupts the tidying up
                pool.close()
                sheet.write()
        print(f"Open {store.folder / 'index.html'}", flush=True)
        return 1 if failed else 0


def _pass(jobs: Iterable[Job], store: Store, pool: Pool, limits: Limits, sheet: Sheet) -> int:
    """Carries out jobs and shows their progress; returns the number of failed jobs."""
    finished = store.finished(jobs)
    progress = BatchProgress(len(finished), sum(finished))

    def tell(what: str, job: Job, row: JobRow) -> None:
        progress.tell(what, job, row)
        if what in ("done", "failed"):
            sheet.update()

    try:
        with progress:
            carry_out(jobs, store, pool, limits, tell, finished)
    finally:
        progress.note(progress.summary())
    return progress.counts["failed"]


def carry_out(
    plan: Iterable[Job], store: Store, pool: Pool, limits: Limits, tell: Tell, finished: Sequence[int] | None = None
) -> None:
    """Carries out the jobs that are not done, and failed ones again, up to a limit; calls `tell` for each event.

    `finished` has for each job of `plan` 1 if it is done, else 0; None to look that up.
    """
    finished = store.finished(plan) if finished is None else finished
    fresh: Iterator[Job] = (job for job, done in zip(plan, finished, strict=True) if not done)
    again: deque[Job] = deque()
    attempts: Counter[str] = Counter()
    losses: Counter[str] = Counter()
    out, exhausted = 0, False
    while True:
        # Idle workers get a fresh job, or else one that failed.
        while out < pool.capacity():
            job = None if exhausted else next(fresh, None)
            exhausted = job is None
            job = again.popleft() if job is None and again else job
            if job is None:
                break
            store.check_space(limits.free_gb)
            pool.submit(job)
            tell("started", job, {})
            out += 1
        if exhausted and not again and not out:
            return
        # A job that ended is done, is tried again, or is given up. A lost worker is at first no failure of its job.
        for job, row in pool.wait(1.0):
            out -= 1
            if row is None:
                losses[job.name] += 1
                if losses[job.name] <= _LOSSES:
                    again.append(job)
                    tell("lost", job, {})
                    continue
                error = f"The machine that worked on it was lost {_LOSSES + 1} times."
                remedy = "Give it more memory: [limits] memory_gb."
                row = head(job) | {"status": "failed", "error": error, "remedy": remedy}
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


def install_job_type(scripts: Path) -> Path:
    """Writes the job type into a Flamenco Manager's folder `scripts`, for this installation; returns its path."""
    scripts = scripts.expanduser().resolve()
    if not scripts.parent.is_dir():
        raise VibeError(f"There is no folder {scripts.parent}.", "Name the folder of your Flamenco Manager.")
    scripts.mkdir(exist_ok=True)
    source = Path(__file__).with_name("flamenco.js").read_text("utf-8")
    script = json.dumps(blender_side().as_posix())[1:-1]
    target = scripts / "vibe-render.js"
    write_bytes(target, source.replace("{{script}}", script).encode())
    return target
