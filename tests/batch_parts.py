# SPDX-License-Identifier: Apache-2.0
"""Batches of simulated jobs, for tests; run as a program, one that can be killed: `batch_parts.py DIR PROMPT...`.

With RAY_CLUSTER=HOST:PORT in the environment it is carried out there.
"""

import os
import sys
from pathlib import Path

from proxy_renderer.batch import command, pools
from proxy_renderer.batch.manifest import BatchPlan, Limits, SceneGroup
from proxy_renderer.batch.pools import LocalPool
from proxy_renderer.batch.store import Sheet, Store
from proxy_renderer.batch.worker import Setup, Worker
from proxy_renderer.schema import VibeError

COMMAND = (str(Path(__file__).with_name("simulated_blender.py")),)
SMALL = Limits(free_gb=0.0, cores=1, memory_gb=0.1, retries=0)
OPTIONS = ("--rounds=1", "--steps=2", "--size=48", "--samples=2")


def plan_of(*prompts, scenes=("a.blend",), seeds=(0,)):
    """A plan of scenes that need not exist."""
    return BatchPlan([SceneGroup(name, Path(name), "digest", tuple(prompts), tuple(seeds), OPTIONS) for name in scenes])


def local(store, setup, workers=1):
    """Workers on this machine."""
    return LocalPool(store.jobs, [Worker(setup) for _ in range(workers)])


def on_cluster(address):
    """Workers on a Ray cluster, which is looked at more often than people need."""
    pools._LOOK = 0.3
    return lambda store, setup, workers: pools.RayPool(address, store, setup)


def carry_out(folder, plan, limits=None, workers=1, pool_of=local):
    """Runs a batch; returns what it told, and its rows."""
    limits, told = limits or Limits(free_gb=0.0), []
    with Store(folder) as store:
        pool = pool_of(store, Setup(limits, command=COMMAND), workers)
        try:
            command.carry_out(plan, store, pool, limits, lambda what, job, row: told.append((what, job.prompt)))
        finally:
            pool.close()
        Sheet("test", plan, store).write()
        return told, list(map(store.row, plan))


def contents(folder):
    """What the jobs have made, without times and logs."""
    names = ("after.png", "preset.json", "vibed.blend", "details.js")
    return {p.relative_to(folder): p.read_bytes() for name in names for p in folder.glob(f"jobs/*/{name}")}


if __name__ == "__main__":
    where = on_cluster(os.environ["RAY_CLUSTER"]) if "RAY_CLUSTER" in os.environ else local
    try:
        carry_out(Path(sys.argv[1]), plan_of(*sys.argv[2:]), SMALL, pool_of=where)
    except VibeError as error:
        sys.exit(f"vibe: {error}")
