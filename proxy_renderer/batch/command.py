# SPDX-License-Identifier: Apache-2.0
"""`vibe batch`: from a manifest to a folder of results."""

from __future__ import annotations

import argparse
import os
import re
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..schema import VibeError
from ..words.lexicon.user_words import VARIABLE
from . import schedule
from .estimate import account
from .finals import Finals
from .local import Pool, fitting, local_pool
from .manifest import manifest
from .plan import BatchPlan, Job, Jobs
from .progress import BatchProgress
from .sheet import Sheet
from .store import JobRow, Store
from .worker import Setup


def run(a: argparse.Namespace) -> int:
    """Carries out the command; returns 0, or 1 if jobs have failed.

    Raises:
        VibeError: The manifest is wrong, or the batch cannot go on.
        KeyboardInterrupt: It was interrupted; what is done stays, and the next run continues.
    """
    wanted = manifest.load(a.manifest, a.out)
    plan = BatchPlan(wanted.groups)
    if a.workers < 0:
        raise VibeError(f"--workers {a.workers} is out of range.", "Use 1 or more, or leave it out.")
    if a.final and not re.fullmatch(r"\d+(-\d+)?", a.final):
        raise VibeError(f"--final {a.final} names no frames.", "Write them as in --final 1-24.")
    if a.dry_run:
        workers = a.workers or fitting(wanted.limits)
        print(account(plan, a.out, 0 if a.ray else workers))
        return 0
    with Store(a.out) as store, _terminable():
        store.check_space(wanted.limits.free_gb)
        return _carry_out(a, plan, store, wanted.limits)


def _carry_out(a: argparse.Namespace, plan: BatchPlan, store: Store, limits: manifest.Limits) -> int:
    sheet = Sheet(a.manifest.stem, plan, store)
    sheet.write()
    print(f"{len(plan)} jobs. Watch {store.folder / 'index.html'}", flush=True)
    pool = _pool(a, store, limits)
    try:
        failed = _pass(plan, store, pool, limits, sheet)
        if a.final is not None:
            failed += _pass(Finals(plan, store, a.final), store, pool, limits, sheet)
    finally:
        with _deaf():
            pool.close()
            sheet.write()
    print(f"Open {store.folder / 'index.html'}", flush=True)
    return 1 if failed else 0


def _pass(jobs: Jobs, store: Store, pool: Pool, limits: manifest.Limits, sheet: Sheet) -> int:
    """Carries out jobs with their progress shown; returns how many have failed."""
    finished = store.finished(jobs)
    progress = BatchProgress(len(finished), sum(finished))

    def tell(what: str, job: Job, row: JobRow) -> None:
        progress.tell(what, job, row)
        if what in ("done", "failed"):
            sheet.update()

    try:
        with progress:
            schedule.run(jobs, store, pool, limits, tell, finished)
    finally:
        progress.note(progress.summary())
    return progress.counts["failed"]


def _pool(a: argparse.Namespace, store: Store, limits: manifest.Limits) -> Pool:
    words = {VARIABLE: os.environ[VARIABLE]} if VARIABLE in os.environ else {}
    setup = Setup(limits, words)
    if a.ray:
        from .cluster import cluster_pool

        return cluster_pool(a.ray, store, setup, a.workers)
    return local_pool(store.jobs, setup, a.workers)


@contextmanager
def _terminable() -> Iterator[None]:
    """SIGTERM is heard like Ctrl-C."""

    def stop(number: int, frame: Any) -> None:
        raise KeyboardInterrupt

    old = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, old)


@contextmanager
def _deaf() -> Iterator[None]:
    """Nothing interrupts the tidying up."""
    old = {n: signal.signal(n, signal.SIG_IGN) for n in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)
