# SPDX-License-Identifier: Apache-2.0
"""``python -m lab train``: from nothing to the embedded encoder.

Traces a bank of views if there is none, trains for the given minutes (going on where the last sitting
stopped), writes the model as an open_clip folder and, with ``--evaluate``, judges it on validation shapes.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import torch

from lab.train.model import CONFIG, JUDGE
from lab.train.pictures import bank, cycles
from lab.train.text.wording import GUIDES, JUDGES
from lab.train.train import TrainingRecipe, train
from proxy_renderer.schema.errors import VibeError

GUIDE, HELD_OUT = 50_000, 100_000
"""Seeds of shapes from the first on are the guide's, those before are the judge's. Those from the second on are
validation: not trained on, but they choose between weights."""


def main(argv: Sequence[str]) -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m lab train", description=__doc__)
    parser.add_argument(
        "--out", type=Path, default=Path("out/train"), help="checkpoint, log, banks and model (default: %(default)s)"
    )
    parser.add_argument("--minutes", type=float, default=60, help="how long this sitting trains (default: %(default)s)")
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--views", type=int, default=1000, help="views in the training bank, when it has to be traced")
    parser.add_argument("--shapes", type=int, default=250, help="shapes in it")
    parser.add_argument("--size", type=int, default=160, help="side of a picture in pixels")
    parser.add_argument("--workers", type=int, default=2, help="processes that trace")
    parser.add_argument(
        "--rate", type=float, default=TrainingRecipe.rate, help="learning rate; it falls towards a sitting's end"
    )
    parser.add_argument(
        "--from",
        dest="start",
        type=Path,
        metavar="FOLDER",
        help="go on from an exported model, where there is no checkpoint",
    )
    parser.add_argument(
        "--cycles", type=int, default=0, metavar="N", help="pairs of Cycles pictures to render, if none are there"
    )
    parser.add_argument("--judge", action="store_true", help="train the judge: other architecture, shapes and wordings")
    parser.add_argument("--groups", type=int, default=TrainingRecipe.groups, help="groups of four pictures per step")
    parser.add_argument("--seed", type=int, default=TrainingRecipe.seed)
    parser.add_argument(
        "--evaluate", type=Path, nargs="*", metavar="MESH", help="judge the model, also on these meshes"
    )
    options = parser.parse_args(argv)
    try:
        _run(options)
    except VibeError as error:
        parser.exit(2, f"{error}\n")


def _run(options: argparse.Namespace) -> None:
    first = 0 if options.judge else GUIDE
    places = {
        options.out / "bank": (options.views, options.shapes, first),
        options.out / "heldout": (240, 48, HELD_OUT),
    }
    for folder, (views, shapes, seed) in places.items():
        if not folder.exists():
            print(f"tracing {views} views of {shapes} shapes into {folder}", flush=True)
            bank.build(folder, views, shapes, seed, options.size, options.workers)
    if options.cycles and not (options.out / "cycles").exists():
        print(f"rendering {options.cycles} pairs of Cycles pictures", flush=True)
        cycles.build(options.out / "cycles", options.cycles, first, options.size)
    recipe = TrainingRecipe(
        groups=options.groups, rate=options.rate, seed=options.seed, split=JUDGES if options.judge else GUIDES
    )
    trainer = train(
        recipe,
        options.out / "bank",
        options.out,
        options.minutes,
        torch.device(options.device),
        JUDGE if options.judge else CONFIG,
        options.start,
    )
    trainer.export(options.out / "model")
    print(f"step {trainer.step}: the model is in {options.out / 'model'}", flush=True)
    if options.evaluate is not None:
        from lab.train.evaluate import evaluate

        evaluate(options.out / "model", options.out / "heldout", options.evaluate, options.out / "results.json")
