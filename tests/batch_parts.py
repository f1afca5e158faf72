# SPDX-License-Identifier: Apache-2.0
"""Batches of simulated jobs, for tests; run as a program, one that can be killed: `batch_parts.py DIR PROMPT...`."""

import sys
from pathlib import Path

from proxy_renderer.batch import schedule
from proxy_renderer.batch.local import LocalPool
from proxy_renderer.batch.manifest import Limits, Shot
from proxy_renderer.batch.plan import Plan
from proxy_renderer.batch.sheet import Sheet
from proxy_renderer.batch.store import Store
from proxy_renderer.batch.worker import Setup, Worker

COMMAND = (sys.executable, str(Path(__file__).with_name("simulated_blender.py")))
OPTIONS = ("--rounds=1", "--steps=2", "--size=48", "--samples=2")


def plan_of(*prompts, scenes=("a.blend",), seeds=(0,)):
    """A plan of scenes that need not exist."""
    return Plan([Shot(name, Path(name), "digest", tuple(prompts), tuple(seeds), OPTIONS) for name in scenes])


def carry_out(folder, plan, limits=None, workers=1):
    """Runs a batch; returns what it told, and its rows."""
    limits, told = limits or Limits(free_gb=0.0), []
    with Store(folder) as store:
        pool = LocalPool(store.jobs, [Worker(Setup(limits, command=COMMAND)) for _ in range(workers)])
        try:
            schedule.run(plan, store, pool, limits, lambda what, job, row: told.append((what, job.prompt)))
        finally:
            pool.close()
        Sheet("test", plan, store).write()
        return told, list(store.rows(plan))


if __name__ == "__main__":
    carry_out(Path(sys.argv[1]), plan_of(*sys.argv[2:]))
