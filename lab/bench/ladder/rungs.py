# SPDX-License-Identifier: Apache-2.0
"""Contribution of each part of the method: the development pairs, run with less and less left out."""

from __future__ import annotations

import fnmatch
import itertools
import json
import random
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from lab.bench.paper import finished, runs, verdict
from lab.bench.paper.pairs import WIDER, read_pairs
from lab.bench.paper.runs import Run, RunBudget
from lab.methods import OURS, PROJECTION, Variation
from proxy_renderer.schema import FAMILIES, Instance, VibeError, atomic, split_key

RUNGS = {
    "projection only": Variation(PROJECTION),
    "middle of the ranges": Variation("middle"),
    "Adam": Variation("adam"),
    "without the encoder": Variation("without-encoder"),
    "the encoder for every word": Variation("every-word"),
    "without the claims": Variation("without-claims"),
    "without sharing": Variation("without-sharing"),
    "without anchors": Variation(options=("--no-anchor",)),
    "full": OURS,
}
"""By name; the artist's own scene is the rung below them."""

BASELINE_STEPS = ("--rounds=1", "--steps=240")
"""As the authors' code has them."""

BASELINES = {f"clip-only, {rate / 10:g} %": Variation("clip-only", rate, BASELINE_STEPS) for rate in (40, 10, 3)} | {
    "clip-authors": Variation("clip-authors", options=BASELINE_STEPS)
}

_ARTIST = "the artist's scene"
_DRAWS = 2000


def run(
    out: Path,
    baselines: bool = False,
    only: str = "*",
    rungs: str = "*",
    size: int = 160,
    rounds: int = 3,
    seeds: int = 1,
) -> dict[str, Any]:
    """Carries out what is missing, measures it, and writes results.json.

    Args:
        out: The folder. OUT/runs keeps every run; one that is there is not done again.
        baselines: Whether the rungs are the baselines at several rates.
        only: A pattern of pairs' names; the paper's own meshes are not used.
        size: Longer side of the pictures, pixels.
        rounds: The most rounds of a run.
        seeds: How many times everything is done.

    Returns:
        The content of results.json: `rungs`, for each `asks`, the mean score of what people read in the prompts, and
        its 95 % `interval` over the pairs; `claims`, the share of the words' claims that hold on Cycles' pictures;
        `seconds` in the loop; with several seeds `spread`, see `spread`; and `failed`.

    Raises:
        VibeError: No pair that has a set of its own has such a name, or no rung.
    """
    ladder = BASELINES if baselines else RUNGS
    taken = {name: rung for name, rung in ladder.items() if fnmatch.fnmatch(name, rungs)}
    if not taken:
        raise VibeError(f"No rung has a name like {rungs!r}.", f"Choose from: {', '.join(ladder)}.")
    pairs = [pair for pair in read_pairs(only) if pair.set and pair.group == WIDER]
    if not pairs:
        raise VibeError(f"No pair with a scene has a name like {only!r}.", "Leave out --only for all.")
    budget = RunBudget(rounds=rounds, size=size, samples=32, seeds=seeds)
    planned = runs.plan_rungs(pairs, taken, budget, out, None)
    broken = runs.carry_out([run for row in planned.values() for run in row], budget, out, None)
    done = {name: [run for run in row if run.done] for name, row in planned.items()}
    results = {
        "rungs": {_ARTIST: _artist(max(done.values(), key=len))}
        | {name: _rung(row, seeds) for name, row in done.items()},
        "pairs": len(pairs),
        "failed": {
            f"{run.pair.name}, {name}": broken[run.folder]
            for name, row in planned.items()
            for run in row
            if run.folder in broken
        },
    }
    atomic.write_text(out / "results.json", json.dumps(results, indent=1, ensure_ascii=False))
    _show(results)
    return results


def _rung(row: Sequence[Run], seeds: int) -> dict[str, Any]:
    """The figures of a rung's runs that are done."""
    scores, claims, seconds = [], [], []
    for done in row:
        before, after = (finished.load(done.folder, which) for which in ("before", "after"))
        scores.append(verdict.alone(done.pair, verdict.read(done.pair, after, before)).whole)
        report = json.loads((done.folder / "report.json").read_text("utf-8"))
        claims += [claim["holds"] for claim in report["claims"] if claim["word"] and claim["holds"] is not None]
        seconds.append(report["timings"]["engine: loop"])
    return (
        _figures(scores)
        | {
            "claims": round(sum(claims) / len(claims), 3) if claims else None,
            "counted": len(claims),
            "seconds": round(sum(seconds) / max(len(seconds), 1), 1),
        }
        | ({"spread": _mean_spread(row)} if seeds > 1 else {})
    )


def _mean_spread(row: Sequence[Run]) -> float:
    """The mean of `spread` over the pairs."""
    reports: dict[str, list[dict[str, Any]]] = {}
    for done in row:
        report = json.loads((done.folder / "report.json").read_text("utf-8"))
        reports.setdefault(done.pair.name, []).append(report["parameters"])
    spreads = [spread(rows) for rows in reports.values()]
    return round(sum(spreads) / max(len(spreads), 1), 4)


def spread(runs: Sequence[Mapping[str, Mapping[str, Any]]]) -> float:
    """Spread over seeds of the values of one scene, prompt and budget.

    Args:
        runs: For each seed, `parameters` of its report.json.

    Returns:
        The mean over all parameters that a run moved, and all pairs of seeds: of the greatest difference of a component,
        in shares of its range on the perceptual scale.
    """
    distances = []
    for key in runs[0]:
        if not any(other[key]["moved"] for other in runs):
            continue
        group, owner, name = split_key(key)
        ends = [_values(other[key]["after"]) for other in runs]
        distances += [
            Instance(FAMILIES[f"{group}/{name}"], owner, a).distance(b) for a, b in itertools.combinations(ends, 2)
        ]
    return sum(distances) / max(len(distances), 1)


def _values(after: float | Sequence[float]) -> tuple[float, ...]:
    return (after,) if isinstance(after, int | float) else tuple(after)


def _artist(row: Sequence[Run]) -> dict[str, Any]:
    """Asks that the artist's scenes have already."""
    scores = []
    for done in row:
        before = finished.load(done.folder, "before")
        scores.append(verdict.alone(done.pair, verdict.read(done.pair, before, before)).whole)
    return _figures(scores)


def _figures(scores: Sequence[float]) -> dict[str, Any]:
    """The mean score and its 95 % interval, by drawing pairs anew (bootstrap, Efron 1979)."""
    dice = random.Random(0)
    means = sorted(sum(dice.choices(scores, k=len(scores))) / len(scores) for _ in range(_DRAWS)) if scores else [0.0]
    low, high = means[int(0.025 * len(means))], means[int(0.975 * len(means))]
    return {
        "asks": round(sum(scores) / max(len(scores), 1), 3),
        "interval": [round(low, 3), round(high, 3)],
        "runs": len(scores),
    }


def _show(results: Mapping[str, Any]) -> None:
    table = Table("rung", "asks", "95 %", "claims", "spread", "loop, s", "runs", box=None, pad_edge=False)
    for name, row in results["rungs"].items():
        low, high = row["interval"]
        claims = f"{row['claims']:.0%}" if row.get("claims") is not None else ""
        table.add_row(
            name,
            f"{row['asks']:.2f}",
            f"{low:.2f}-{high:.2f}",
            claims,
            f"{row['spread']:.3f}" if "spread" in row else "",
            f"{row.get('seconds', '')}",
            f"{row['runs']}",
        )
    console = Console(width=None if Console().is_terminal else 120)
    console.print(table)
    for name, message in results["failed"].items():
        console.print(f"FAILED {name}: {message}", style="red", markup=False)
