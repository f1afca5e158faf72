# SPDX-License-Identifier: Apache-2.0
"""The experiment: runs, readings, verdicts and their summary."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from lab.bench.paper import figures, finished, judge, page, runs, verdict
from lab.bench.paper.pairs import COMPARED, Pair, read_pairs
from lab.bench.paper.runs import BASELINE, Run, RunBudget
from lab.methods import OURS
from proxy_renderer.schema import VibeError, atomic
from proxy_renderer.schema.messages import Options
from proxy_renderer.vlm.client import Client
from proxy_renderer.vlm.endpoint import find_endpoint
from proxy_renderer.vlm.judge import judge as ask_model

_QUICK = RunBudget(rounds=2, steps=8, size=160, samples=16, seeds=1, anchor=False)
_WINNERS = {"OURS": "win", "TIE": "tie", "CLIP-ONLY": "loss"}
_ABLATIONS = ("concrete_vs_abstract", "prompt_extension")


def run(
    out: Path, quick: bool = False, seeds: int | None = None, only: str = "*", mesh_folder: str = ""
) -> dict[str, Any]:
    """Carries out what is missing, measures everything, and writes results.json, report.html and the figures.

    Args:
        out: The folder. OUT/runs keeps every run; one that is there is not done again.
        quick: Few steps, small pictures, one seed.
        seeds: How many; None for three, or one where it has to be quick.
        mesh_folder: Where the paper's meshes are; "" to look beside the clone.

    Returns:
        The content of results.json: `win`, `tie`, `loss`, `win_rate`, `interval`, `pairs` (how many were decided),
        `without_visibility`: the same figures of scores in which a hidden subject does not count, `by_pair`,
        `ablations`, `judge`, `budget`, and `failed` with what could not be run, and why.
    """
    budget = _budget(quick, seeds)
    meshes = runs.find_meshes(mesh_folder)
    asked = read_pairs(only)
    pairs = [pair for pair in asked if pair.set or meshes]
    if len(pairs) < len(asked):
        print("The paper's own meshes are not here, so its pairs are left out: name their folder by --meshes.")
    planned = runs.plan(pairs, budget, out, meshes)
    broken = runs.carry_out(planned, budget, out, meshes)
    results = summary(planned, budget) | {
        "failed": {
            f"{r.pair.name}, {r.variation}, seed {r.seed}": broken[r.folder] for r in planned if r.folder in broken
        }
    }
    atomic.write_text(out / "results.json", json.dumps(results, indent=1, ensure_ascii=False))
    _figures(planned, out)
    atomic.write_text(out / "report.html", page.render(results, planned, out))
    _print(results)
    return results


def summary(planned: Sequence[Run], budget: RunBudget) -> dict[str, Any]:
    """The figures of the runs that are done, measured and judged.

    Returns:
        The content of results.json but for `failed`; see `run`.
    """
    network = judge.find()
    readings = {r.folder: _read(r, network) for r in planned if r.done}
    by_pair, ablations = {}, {}
    for pair in dict.fromkeys(r.pair for r in planned):
        mine = [r for r in planned if r.pair == pair and r.done]
        if pair.group in COMPARED:
            if record := _compared(pair, mine, readings):
                by_pair[pair.name] = record
        elif mine:
            score = verdict.alone(pair, readings[mine[0].folder])
            ablations[pair.name] = _facts(pair) | {"ours": _record(pair, readings[mine[0].folder], score)}
    return {
        **verdict.tally([row["verdict"] for row in by_pair.values()]),
        "without_visibility": verdict.tally([row["without_visibility"]["verdict"] for row in by_pair.values()]),
        "pairs": len(by_pair),
        "rule": verdict.RULE,
        "judge_encoder": network is not None,
        "judge": _model(planned),
        "budget": vars(budget),
        "by_pair": by_pair,
        "ablations": ablations,
    }


def _budget(quick: bool, seeds: int | None) -> RunBudget:
    chosen = _QUICK if quick else RunBudget()
    if seeds is not None and not 1 <= seeds <= 100:
        raise VibeError(f"--seeds {seeds} is out of range.", "Use 1 to 100.")
    return replace(chosen, seeds=seeds or chosen.seeds)


def _read(done: Run, network: judge.Judge | None) -> verdict.Reading:
    before, after = (finished.load(done.folder, which) for which in ("before", "after"))
    gain = network.gain(done.pair.prompt, before.display, after.display) if network else None
    return verdict.read(done.pair, after, before, gain)


def _compared(pair: Pair, mine: Sequence[Run], readings: Mapping[Path, verdict.Reading]) -> dict[str, Any]:
    """One pair over its seeds; empty while no seed has both methods."""
    seeds: list[dict[str, Any]] = []
    for seed in sorted({r.seed for r in mine}):
        both = {r.variation: readings[r.folder] for r in mine if r.seed == seed}
        if len(both) == 2:
            scores = verdict.compare(pair, both[OURS], both[BASELINE])
            folders = {r.variation: r.folder.name for r in mine if r.seed == seed}
            seeds.append(
                {
                    "seed": seed,
                    "ours": _record(pair, both[OURS], scores[0]) | {"run": folders[OURS]},
                    "clip_only": _record(pair, both[BASELINE], scores[1]) | {"run": folders[BASELINE]},
                }
            )
    if not seeds:
        return {}
    blind = _decided(seeds, "score_without_visibility")
    return _facts(pair) | _decided(seeds, "score") | {"without_visibility": blind, "seeds": seeds}


def _decided(seeds: Sequence[Mapping[str, Any]], score: str) -> dict[str, Any]:
    """Who has won by a score, and both means over the seeds."""
    ours, theirs = ([seed[side][score] for seed in seeds] for side in ("ours", "clip_only"))
    means = {"ours": sum(ours) / len(ours), "clip_only": sum(theirs) / len(theirs)}
    return {"verdict": verdict.decide(ours, theirs), **{side: round(value, 4) for side, value in means.items()}}


def _facts(pair: Pair) -> dict[str, Any]:
    return {"group": pair.group, "prompt": pair.prompt, "asks": [ask.text for ask in pair.asks]}


def _record(pair: Pair, reading: verdict.Reading, score: verdict.Score) -> dict[str, Any]:
    rows = zip(pair.asks, reading.amounts, score.asks, strict=True)
    return {
        "score": round(score.whole, 4),
        "score_without_visibility": round(score.mean, 4),
        "asks": {ask.text: {"amount": round(amount, 3), "score": round(part, 3)} for ask, amount, part in rows},
        "visibility": {k: round(v, 3) for k, v in vars(reading.visible).items()},
        **({} if reading.judge is None else {"judge_gain": reading.judge}),
    }


def _rows(planned: Sequence[Run], group: str) -> list[tuple[Pair, Path, Path]]:
    """The pairs of a group with both folders of the first seed; an ablation's second one is its first."""
    rows = []
    for pair in dict.fromkeys(r.pair for r in planned if r.pair.group == group):
        folders = {r.variation: r.folder for r in planned if r.pair == pair and r.seed == 0 and r.done}
        if OURS in folders and (BASELINE in folders or group not in COMPARED):
            rows.append((pair, folders[OURS], folders.get(BASELINE, folders[OURS])))
    return rows


def _figures(planned: Sequence[Run], out: Path) -> None:
    if rows := _rows(planned, "benchmark"):
        figures.save_benchmark(rows, out / "figure.png")
    for group in _ABLATIONS:
        if rows := _rows(planned, group):
            figures.save_ablation([(pair, folder) for pair, folder, _ in rows], out / f"{group}.png")


def _model(planned: Sequence[Run]) -> dict[str, Any]:
    """A vision-language model's verdicts by the paper's own prompt; empty where none is configured.

    Returns:
        `model`; `figure`, its word on the paper's figure; `pairs`, its word on each; `win`, `tie` and `loss` of these;
        and what it cost.
    """
    endpoint = find_endpoint(Options())
    if endpoint is None:
        return {}
    client = Client(endpoint)

    def word_on(rows: Sequence[tuple[Pair, Path, Path]]) -> dict[str, str]:
        try:
            return asdict(ask_model(client, figures.columns(rows)))
        except VibeError as error:
            return {"error": str(error)}

    verdicts: dict[str, Any] = {"model": endpoint.model}
    if benchmark := _rows(planned, "benchmark"):
        verdicts["figure"] = word_on(benchmark)
    verdicts["pairs"] = {row[0].name: word_on([row]) for group in COMPARED for row in _rows(planned, group)}
    winners = [word.get("winner") for word in verdicts["pairs"].values()]
    counts = {kind: winners.count(name) for name, kind in _WINNERS.items()}
    return verdicts | counts | client.usage.account()


def _print(results: Mapping[str, Any]) -> None:
    for name, row in sorted(results["by_pair"].items(), key=lambda pair: pair[1]["ours"] - pair[1]["clip_only"]):
        print(f"{row['verdict']:>5}  {row['ours']:.2f} : {row['clip_only']:.2f}  {name}: {row['prompt'][:70]}")
    if judged := results["judge"]:
        print(
            f"{judged['model']} by the paper's prompt: {judged['win']} won, {judged['tie']} tied, {judged['loss']} lost."
        )
    for says, row in (
        ("Ours against CLIP-only", results),
        ("Whether or not the subject can be seen", results["without_visibility"]),
    ):
        low, high = row["interval"]
        print(
            f"{says}: {row['win']} won, {row['tie']} tied, {row['loss']} lost of {results['pairs']}; "
            f"win rate {row['win_rate']:.0%} (95 % interval {low:.0%} to {high:.0%})."
        )
