# SPDX-License-Identifier: Apache-2.0
"""A picture as the words: tasks from a seed, carried out where they have not been, compared, and shown."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

from PIL import Image

from lab.bench.like import table
from lab.bench.like.tasks import PARTS, tasks
from lab.bench.like.trial import LikeTrial
from lab.bench.sheet import Strip, save_sheets
from proxy_renderer.schema import VibeError, atomic

_MOST = 1000


def run(
    out: Path,
    count: int = 4,
    parts: str = ",".join(PARTS),
    drawn_from: str = "like",
    size: int = 160,
    samples: int = 32,
    effort: str = "standard",
    words: bool = False,
) -> dict[str, Any]:
    """Carries out what is missing, compares, and writes OUT/results.json, after each task, and contact sheets.

    The parts take turns, so that a run that is broken off has tasks of each.

    Args:
        out: The folder; it keeps scenes and runs, and one that is there is not done again.
        count: Tasks of each part; fewer are the first of more.
        parts: Of `PARTS`, separated by commas.
        size: Longer side of the pictures, pixels.
        effort: As for `vibe run`.
        words: Whether the scenes of *recovery* are vibed in words as well, to compare the time.

    Returns:
        The content of results.json; see `table.summary`.

    Raises:
        VibeError: There is no such part, or pilgram is missing for the filters.
    """
    if not 1 <= count <= _MOST:
        raise VibeError(f"--tasks {count} is out of range.", f"Use 1 to {_MOST}.")
    chosen = [name for name in parts.split(",") if name]
    if strange := [name for name in chosen if name not in PARTS] or not chosen:
        raise VibeError(f"There is no part {strange}.", f"Use some of: {', '.join(PARTS)}.")
    drawn = [list(tasks(part, count, drawn_from)) for part in chosen]
    turns = [t for turn in itertools.zip_longest(*drawn) for t in turn if t is not None]
    rows, strips, settings = [], [], {"seed": drawn_from, "size": size, "samples": samples, "effort": effort}
    for number, task in enumerate(turns, 1):
        trial = LikeTrial(task, out, size, samples, effort, words)
        row = trial.row()
        print(f"[{number}/{len(turns)}] {row['task']}: {table.line(row)}", flush=True)
        rows.append(row)
        strips.append(_strip(trial, row))
        atomic.write_text(out / "results.json", json.dumps(table.summary(rows) | settings, indent=1))
    save_sheets(strips, out)
    results = table.summary(rows) | settings
    table.show(results)
    return results


def _strip(trial: LikeTrial, row: table.LikeRow) -> Strip:
    panels = []
    for name, path in trial.pictures().items():
        with Image.open(path) as picture:
            panels.append((name, picture.convert("RGB")))
    return Strip(row["task"], table.line(row), panels)
