# SPDX-License-Identifier: Apache-2.0
"""Runs of the product and of the baseline: each in a folder named by all that its result depends on, and kept."""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import proxy_renderer
from lab import methods
from lab.bench import blender
from lab.bench.paper.pairs import COMPARED, Pair
from lab.methods import OURS, Variation
from proxy_renderer.blender.launch import blender_side
from proxy_renderer.schema import VibeError, atomic

BASELINE = Variation("clip-only")


@dataclass(frozen=True)
class RunBudget:
    """The same for both methods.

    Attributes:
        rounds: Of Algorithm 1.
        steps: In each round.
        size: Side of the pictures, pixels.
        samples: Of Cycles.
        seeds: How many times everything is done.
        anchor: Whether small pictures of Cycles correct the proxy meanwhile.
    """

    rounds: int = 6
    steps: int = 40
    size: int = 512
    samples: int = 128
    seeds: int = 3
    anchor: bool = True


@dataclass(frozen=True)
class Run:
    """One vibe.

    Attributes:
        pair: What is asked for.
        variation: `OURS`, `BASELINE` or another one.
        seed: Of all chance in it.
        folder: Where it is kept.
    """

    pair: Pair
    variation: Variation
    seed: int
    folder: Path

    @property
    def done(self) -> bool:
        """True if all of it is there: the mask of the artist's picture comes last."""
        return (self.folder / "mask_before.png").is_file()


def plan(pairs: Sequence[Pair], budget: RunBudget, out: Path, meshes: Path | None) -> list[Run]:
    """All runs, both methods of a pair side by side; all pairs with the first seed come first.

    Args:
        budget: How much each run may do.
        out: The results folder; a run's folder in it is named by all that its result depends on.
        meshes: Folder of the paper's meshes; None if they are not here.
    """
    code = _fingerprint()
    planned = []
    for seed in range(budget.seeds):
        for pair in pairs:
            for each in (OURS, BASELINE) if pair.group in COMPARED else (OURS,):
                planned.append(Run(pair, each, seed, _folder(pair, each, seed, budget, out, meshes, code)))
    return planned


def plan_rungs(
    pairs: Sequence[Pair], rungs: Mapping[str, Variation], budget: RunBudget, out: Path, meshes: Path | None
) -> dict[str, list[Run]]:
    """Runs of each rung; those of a pair are told apart by their folders.

    Args:
        budget: How much each run may do.
        meshes: Folder of the paper's meshes; None if no pair needs it.
    """
    code = _fingerprint()
    planned: dict[str, list[Run]] = {name: [] for name in rungs}
    for seed, pair in itertools.product(range(budget.seeds), pairs):
        for name, each in rungs.items():
            planned[name].append(Run(pair, each, seed, _folder(pair, each, seed, budget, out, meshes, code)))
    return planned


def _folder(
    pair: Pair, variation: Variation, seed: int, budget: RunBudget, out: Path, meshes: Path | None, code: str
) -> Path:
    given = arguments(pair, variation, seed, budget)
    what = [pair.set, _content(meshes, pair), str(variation), *given, code]
    return out / "runs" / hashlib.sha256("\n".join(what).encode()).hexdigest()[:20]


def arguments(pair: Pair, variation: Variation, seed: int, budget: RunBudget) -> list[str]:
    """The options of a run, as `vibe run` has them; no model plans, so that both methods have the encoder alone."""
    given = {
        "prompt": pair.prompt,
        "rounds": budget.rounds,
        "steps": budget.steps,
        "size": budget.size,
        "samples": budget.samples,
        "seed": seed,
        "vlm-model": "off",
        "device": "cpu",
    }
    anchor = [] if budget.anchor else ["--no-anchor"]
    return [f"--{name}={value}" for name, value in given.items()] + [*anchor, "--figures", *variation.options]


def carry_out(runs: Sequence[Run], budget: RunBudget, out: Path, meshes: Path | None) -> dict[Path, str]:
    """Does the runs that are not done yet, in one Blender with one engine.

    Args:
        meshes: Folder of the paper's meshes; None if no run needs it.

    Returns:
        A failed run's folder -> why it failed.
    """
    todo = {run.folder.name: run for run in runs if not run.done}
    if not todo:
        return {}
    work = out / "runs.json"
    rows = []
    for name, run in todo.items():
        pair = run.pair
        scene = {"set": pair.set} if pair.set else {"mesh": str(_mesh(meshes, pair))}
        given = arguments(pair, run.variation, run.seed, budget)
        row = {"name": name, "folder": str(run.folder), "clear": pair.foggy, "arguments": given}
        rows.append(row | {"environment": run.variation.environment} | scene)
    atomic.write_text(work, json.dumps(rows, indent=1))
    failed = {}
    done = len(runs) - len(todo)
    for event in blender.scenes("*", [f"--work={work}"], "paper"):
        if event["type"] == "names":
            continue
        run = todo[event["name"]]
        done += 1
        outcome = f"{event['seconds']:.0f} s"
        if event["type"] == "failed":
            failed[run.folder] = event["message"]
            outcome = f"FAILED: {event['message']}"
        print(f"[{done}/{len(runs)}] {run.pair.name}, {run.variation}, seed {run.seed}: {outcome}", flush=True)
    return failed


def find_meshes(chosen: str) -> Path | None:
    """The folder of the paper's meshes: the one that is named, else `shared/meshes` beside a clone; None without.

    Raises:
        VibeError: The one that is named is no folder.
    """
    if chosen:
        folder = Path(chosen).expanduser()
        if not folder.is_dir():
            raise VibeError(f"There is no folder {chosen}.", "It has to hold dolphin.obj, teapot.obj and tree.obj.")
        return folder.resolve()
    beside = Path(proxy_renderer.__file__).resolve().parents[2] / "shared" / "meshes"
    return beside if beside.is_dir() else None


def _mesh(meshes: Path | None, pair: Pair) -> Path:
    assert meshes is not None
    path = meshes / pair.mesh
    if not path.is_file():
        raise VibeError(f"There is no file {path}.", "Name the folder of the paper's meshes by --meshes.")
    return path


def _content(meshes: Path | None, pair: Pair) -> str:
    return hashlib.sha256(_mesh(meshes, pair).read_bytes()).hexdigest() if pair.mesh else ""


def _fingerprint() -> str:
    """A hash of the code and weights that a result depends on."""
    digest = hashlib.sha256()
    folders = [Path(proxy_renderer.__file__).parent, Path(methods.__file__).parent, blender_side().parent]
    files = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    for path in sorted(files):
        if path.suffix in (".py", ".toml", ".txt", ".json", ".safetensors"):
            digest.update(path.name.encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()
