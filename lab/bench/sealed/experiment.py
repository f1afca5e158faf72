# SPDX-License-Identifier: Apache-2.0
"""The sealed set: prompts and scenes from a seed, the product's pictures of them, and the judge's verdicts."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from PIL import Image

from lab.bench.sealed import contest, table
from lab.bench.sealed.commit import judged_commit
from lab.bench.sealed.prompts import SealedJob, draw
from lab.bench.sealed.trial import SealedTrial
from lab.bench.sheet import Strip, save_sheets
from lab.methods import OURS, Variation
from proxy_renderer.schema import VibeError, atomic

_MOST = 100_000


def run(
    out: Path,
    jobs: int = 24,
    drawn_from: str = "",
    long: bool = False,
    size: int = 160,
    samples: int = 32,
    rival: str = "",
    rate: int = 0,
) -> dict[str, Any]:
    """Draws, carries out what is missing, judges, and writes OUT/results.json and contact sheets.

    Args:
        out: The folder. OUT/runs keeps each job's scene and pictures; one that is there is not done again.
        jobs: How many prompts; fewer are the first of more.
        drawn_from: The seed, any text; "" for the hash of the judged commit.
        long: Prompts of three to five asks, see `prompts.draw`.
        size: Longer side of the pictures, pixels.
        rival: One that gets the same jobs, see `contest.rival_row`; "" for none.
        rate: The rival's greatest step, in thousandths of a range; 0 for its own.

    Returns:
        The content of results.json; see `table.summary`, and `contest.summary` for `contest`. Beside that `seed`, and `changed_files`: whether the clone has
        files that the commit does not have, in which case others cannot repeat it.

    Raises:
        VibeError: There is neither a seed nor a commit.
    """
    if not 1 <= jobs <= _MOST:
        raise VibeError(f"--jobs {jobs} is out of range.", f"Use 1 to {_MOST}.")
    chosen, changed = (drawn_from, False) if drawn_from else judged_commit()
    print(f"Drawn from {chosen}{'; files have been changed since this commit' if changed else ''}.", flush=True)
    rows, rivals, strips = [], [], []
    for number in range(jobs):

        def carried_out(variation: Variation = OURS, number: int = number) -> table.JobResult:
            return _row(_trial(out, chosen, draw(chosen, number, long), size, samples, variation))

        row = carried_out()
        print(f"[{number + 1}/{jobs}] {row['prompt']}: {table.line(row)}", flush=True)
        rows.append(row)
        strips.append(_strip(row, out))
        if rival:
            rivals.append(contest.rival_row(rival, rate, row, carried_out))
            print(f"    {rival}: {table.line(rivals[-1])}", flush=True)
            strips.append(_strip(rivals[-1], out))
    budget = {"long": long, "size": size, "samples": samples, "rival": rival, "rate": rate}
    results = table.summary(rows) | {"seed": chosen, "changed_files": changed, **budget}
    if rival:
        results["contest"] = contest.summary(rows, rivals)
    save_sheets(strips, out)
    atomic.write_text(out / "results.json", json.dumps(results, indent=1, ensure_ascii=False))
    table.show(results)
    if rival:
        contest.show(rival, results["contest"])
    return results


def _trial(out: Path, seed: str, job: SealedJob, size: int, samples: int, variation: Variation) -> SealedTrial:
    """A trial in a folder that is named by all that it depends on, but for changed files."""
    depends = [seed, job.number, size, samples, *variation, job.prompt, job.scene.plain]
    name = hashlib.sha256(json.dumps(depends).encode()).hexdigest()[:16]
    folder = out / "runs" / f"{job.number:03d}-{name}"
    return SealedTrial(job, folder, size, samples, variation)


def _row(trial: SealedTrial) -> table.JobResult:
    return {**trial.row(), "run": trial.folder.name, "asked": len(trial.job.asks)}


def _strip(row: Mapping[str, Any], results: Path) -> Strip:
    """The prompt, its ticks, and what there is of both pictures."""
    panels, out = [], results / "runs" / row["run"] / "out"
    for name in ("before", "after"):
        if (out / f"{name}.png").is_file():
            with Image.open(out / f"{name}.png") as picture:
                panels.append((name, picture.convert("RGB")))
    ticks = "   ".join(("+ " if a["holds"] else "- ") + a["words"] for a in row.get("asks", ()))
    unseen = "" if row.get("seen", True) else "   (hardly seen)"
    note = row["error"] or f"{ticks}{unseen}"
    return Strip(row["prompt"][:56], note[:80], panels or [("no picture", Image.new("RGB", (256, 256)))])
