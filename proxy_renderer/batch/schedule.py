# SPDX-License-Identifier: Apache-2.0
"""Workers on this machine, and the loop that hands out jobs until all are done or given up."""

import os
import queue
import shutil
import subprocess
from collections import Counter, deque
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from pathlib import Path
from typing import Protocol

import psutil

from .manifest import Job, Jobs, Limits
from .store import JobRow, Store, head
from .worker import Interrupted, Setup, Worker

PER_GPU = 4  # engines that share a graphics card


class Pool(Protocol):
    """Workers, wherever they are."""

    def capacity(self) -> int:
        """Number of jobs that can run at the same time, at this moment."""

    def submit(self, job: Job) -> None:
        """Hands out a job."""

    def wait(self, seconds: float) -> list[tuple[Job, JobRow | None]]:
        """Waits for jobs to end; returns them with their rows, None for a job whose worker is lost."""

    def close(self) -> None:
        """Ends all workers now."""


class LocalPool:
    """A `Pool` on this machine, with a thread for each worker."""

    def __init__(self, jobs: Path, workers: list[Worker]) -> None:
        self._jobs, self._workers = jobs, workers
        self._idle: queue.SimpleQueue[Worker] = queue.SimpleQueue()
        for worker in workers:
            self._idle.put(worker)
        self._threads = ThreadPoolExecutor(len(workers))
        self._out: dict[Future[JobRow], Job] = {}

    def capacity(self) -> int:
        """Number of workers, idle or not."""
        return len(self._workers)

    def submit(self, job: Job) -> None:
        """Hands a job to the next worker that is idle."""
        self._out[self._threads.submit(self._run, job)] = job

    def wait(self, seconds: float) -> list[tuple[Job, JobRow | None]]:
        """As `Pool.wait`; a job whose worker was closed has the status "interrupted"."""
        ended, _ = wait(self._out, seconds, FIRST_COMPLETED)
        return [(self._out.pop(future), future.result()) for future in ended]

    def close(self) -> None:
        """Ends the jobs that run, forgets those that wait, and returns when all threads have ended."""
        for worker in self._workers:
            worker.close()
        self._threads.shutdown(wait=True, cancel_futures=True)

    def _run(self, job: Job) -> JobRow:
        worker = self._idle.get()
        try:
            return worker.run(job, self._jobs / job.name)
        except Interrupted:
            return {"status": "interrupted"}
        finally:
            self._idle.put(worker)


def local_pool(jobs: Path, setup: Setup, count: int = 0) -> LocalPool:
    """A pool of `count` workers, or of as many as fit for 0; several have CPU cores of their own, and GPUs in turn."""
    count = count or fitting(machine(), setup.limits) or 1
    cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
    cards = graphics_cards()

    def worker(number: int) -> Worker:
        first = number * setup.limits.cores
        mine = cores[first : first + setup.limits.cores] if count > 1 else []
        card = {"CUDA_VISIBLE_DEVICES": str(number % cards)} if cards else {}
        return Worker(Setup(setup.limits, setup.variables | card, setup.command), mine)

    return LocalPool(jobs, [worker(number) for number in range(count)])


def fitting(resources: Mapping[str, float], limits: Limits) -> int:
    """Number of workers that a machine holds, by its "CPU" cores, "memory" in bytes and "GPU" cards; 0 if it is too small."""
    fits = [int(resources.get("CPU", 0) // limits.cores)]
    fits.append(int(resources.get("memory", 0) / 1e9 // limits.memory_gb))
    if cards := resources.get("GPU"):
        fits.append(int(cards * PER_GPU))
    return min(fits)


def machine() -> dict[str, float]:
    """The resources of this machine, named as Ray names them."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return {"CPU": cores, "memory": psutil.virtual_memory().total, "GPU": graphics_cards()}


def graphics_cards() -> int:
    """Number of CUDA cards, found without importing torch."""
    chosen = os.environ.get("CUDA_VISIBLE_DEVICES")
    if chosen is not None:
        return len([c for c in chosen.split(",") if c.strip()])
    if not shutil.which("nvidia-smi"):
        return 0
    done = subprocess.run(["nvidia-smi", "-L"], capture_output=True, text=True, timeout=30)
    return done.stdout.count("GPU ") if done.returncode == 0 else 0


_LOSSES = 5  # times that a job's worker may be lost before the job counts as failed


def run(
    plan: Jobs,
    store: Store,
    pool: Pool,
    limits: Limits,
    tell: Callable[[str, Job, JobRow], None],
    finished: bytearray | None = None,
) -> None:
    """Carries out the jobs that are not done; `tell` is called with "started", "done", "failed", "again" or "lost".

    `finished` has for each job 1 if it is done, else 0; None to look it up.
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
