# SPDX-License-Identifier: Apache-2.0
"""The overhead of `vibe batch`: by workers with real jobs, by jobs with simulated ones."""

from __future__ import annotations

import json
import shutil
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import psutil
import trimesh
from rich.box import SIMPLE
from rich.console import Console
from rich.table import Table

from proxy_renderer.batch import command, manifest
from proxy_renderer.batch.manifest import BatchPlan, Job, Limits, SceneGroup
from proxy_renderer.batch.pools import LocalPool, local_pool
from proxy_renderer.batch.store import DONE, JobRow, Sheet, Store, head, read_json, tidy, write_json
from proxy_renderer.batch.worker import Setup, Worker
from proxy_renderer.schema import VibeError

_MANIFEST = """
scenes = ["ball.obj"]
prompts = ["noir", "golden hour", "misty, cool blue fog", "glossy teal"]
seeds = {seeds}
[options]
rounds = 1
steps = 8
size = 128
samples = 8
[limits]
memory_gb = 8
cores = 1
retries = 0
minutes = 60
"""
_PROMPTS, _HANDS = 10, 4  # of simulated batches: prompts of each scene, and jobs at a time
_SIMULATED = {
    "": "Jobs",
    "start_s": "start, s",
    "all_s": "all, s",
    "ms_per_job": "each, ms",
    "second_run_s": "again, s",
    "both_cpu_s": "CPU, s",
    "sheet_s": "sheet, s",
    "memory_mb": "MB",
}
_REAL = {
    "": "Workers",
    "jobs_per_hour": "jobs/h",
    "seconds": "a job, s",
    "overhead_s": "beside the vibe, s",
    "outside_of_loop_and_cycles_s": "beside loop and Cycles, s",
    "memory_gb_per_worker": "GB each",
}
"""Columns of the tables, by the names of the figures; see `run`."""


def run(out: Path, jobs: int = 8, workers: str = "1,2,4", simulated: str = "10,100,1000") -> dict[str, Any]:
    """Measures and writes OUT/results.json.

    Args:
        jobs: Real vibes for each number of workers; 0 for none.
        workers: Numbers of workers, "1,2,4".

    Returns:
        `simulated`: for each number of jobs the seconds until the first one starts, until all are done, for a second
        run that finds all done, of the processor for both, for writing the sheet, and the memory that this process has grown by;
        `workers`: for each number jobs per hour, and per warm job its seconds, those outside of `vibe run`'s own
        work, those outside of the loop and of Cycles, and the memory.

    Raises:
        VibeError: There are too few jobs for the workers, or a job has failed.
    """
    counts = _numbers(workers) if jobs else []
    if jobs and jobs <= max(counts):
        raise VibeError(
            f"{jobs} jobs are too few for {max(counts)} workers: each one's first job only warms it.",
            f"Use --jobs {2 * max(counts)} or more.",
        )
    results: dict[str, Any] = {"simulated": {}, "workers": {}}
    for number in _numbers(simulated):
        results["simulated"][number] = _simulated(number)
        print(f"{number} simulated jobs are done.", flush=True)
    for number in counts:
        results["workers"][number] = _real(out, jobs, number)
        print(f"{number} worker{'s' if number > 1 else ''}: done.", flush=True)
    (out / "results.json").write_text(json.dumps(results, indent=1), encoding="utf-8")
    for title, columns in (("simulated", _SIMULATED), ("workers", _REAL)):
        if results[title]:
            Console().print(_table(columns, results[title]))
    return results


def _table(columns: dict[str, str], rows: dict[int, JobRow]) -> Table:
    """The same figures for people."""
    table = Table(*columns.values(), box=SIMPLE)
    for column in table.columns:
        column.justify = "right"
    for number, row in rows.items():
        table.add_row(f"{number:,}", *(f"{row[name]:,}" for name in [*columns][1:]))
    return table


def _numbers(text: str) -> Sequence[int]:
    return [int(part) for part in text.split(",") if part.strip()]


class _Simulated(Worker):
    """A worker whose vibes take no time; it writes only the row of a finished job."""

    def run(self, job: Job, folder: Path) -> JobRow:
        tidy(folder)
        row = head(job) | {"status": "done", "visible": ["misty"], "missed": ["noir"], "delta_e": 1.0}
        row |= {"seconds": 60.0, "seconds_loop": 40.0, "seconds_cycles": 10.0, "memory_gb": 2.0}
        write_json(folder / DONE, row)
        return row

    def close(self) -> None:
        pass


def _simulated(count: int) -> JobRow:
    """A batch of simulated jobs in a fresh folder."""
    prompts = tuple(f"a look of which there are many, number {i}" for i in range(min(_PROMPTS, count)))
    scenes = count // len(prompts)
    plan = BatchPlan(
        [SceneGroup(f"{i}.blend", Path("x.blend"), str(i), prompts, (0,), ("--rounds=6",)) for i in range(scenes)]
    )
    process, began = psutil.Process(), [0.0]
    before, start, worked = process.memory_info().rss, time.monotonic(), time.process_time()

    def tell(what: str, job: Job, row: JobRow) -> None:
        began[0] = began[0] or time.monotonic() - start

    def carry_out(store: Store) -> float:
        first, pool = time.monotonic(), LocalPool(store.jobs, [_Simulated(Setup()) for _ in range(_HANDS)])
        command.carry_out(plan, store, pool, Limits(free_gb=0.1), tell)
        pool.close()
        return round(time.monotonic() - first, 3)

    folder = Path(tempfile.mkdtemp(prefix="vibe-bench-"))
    try:
        with Store(folder) as store:
            seconds, again = carry_out(store), carry_out(store)
            worked = round(time.process_time() - worked, 3)
            grown = process.memory_info().rss - before
            first = time.monotonic()
            Sheet("bench", plan, store).write()
            sheet = round(time.monotonic() - first, 3)
    finally:
        shutil.rmtree(folder)
    return {
        "start_s": round(began[0], 3), "all_s": seconds, "ms_per_job": round(1000 * seconds / len(plan), 3),
        "second_run_s": again, "both_cpu_s": worked, "sheet_s": sheet, "memory_mb": round(grown / 1e6, 1),
    }  # fmt: skip


def _real(out: Path, jobs: int, workers: int) -> JobRow:
    """A batch of quick vibes of a ball, by as many workers; the first job of each warms it, and is left out."""
    folder = Path(tempfile.mkdtemp(prefix=f"batch-{workers}-", dir=out))
    trimesh.creation.icosphere(4).export(folder / "ball.obj")
    (folder / "m.toml").write_text(_MANIFEST.format(seeds=list(range(-(-jobs // 4)))))
    plan, limits = manifest.load(folder / "m.toml", folder / "out")
    ended: list[tuple[str, float]] = []
    with Store(folder / "out") as store:
        pool = local_pool(store.jobs, Setup(limits), workers)
        try:
            command.carry_out(plan, store, pool, limits, lambda what, job, row: ended.append((what, time.monotonic())))
        finally:
            pool.close()
        rows = [row for row in map(store.row, plan) if row["status"] == "done"]
        if len(rows) < len(plan):
            raise VibeError(f"{len(plan) - len(rows)} of {len(plan)} jobs have failed.", f"See {store.jobs}.")
        laps = [(read_json(store.folder / row["folder"] / "report.json") or {})["timings"]["total"] for row in rows]
    warm = slice(workers, None)
    done = [when for what, when in ended if what == "done"]
    seconds = [row["seconds"] for row in rows[warm]]
    outside = [s - lap for s, lap in zip(seconds, laps[warm], strict=True)]
    bare = [r["seconds"] - r["seconds_loop"] - r["seconds_cycles"] for r in rows[warm]]
    return {
        "jobs_per_hour": round(3600 * len(done[warm]) / (done[-1] - done[workers - 1]), 1),
        "seconds": _mean(seconds),
        "overhead_s": _mean(outside),
        "outside_of_loop_and_cycles_s": _mean(bare),
        "memory_gb_per_worker": max(row["memory_gb"] for row in rows),
    }


def _mean(values: Sequence[float]) -> float:
    return round(sum(values) / len(values), 2)
