# SPDX-License-Identifier: Apache-2.0
"""``python -m proxy_renderer.train``: from nothing to the embedded encoder.

Traces a bank of views if there is none, trains for the given minutes (going on where the last sitting
stopped), writes the model as an open_clip folder and, with ``--evaluate``, judges it on held-out shapes.
"""

import argparse
from pathlib import Path

import torch

from ..schema.errors import VibeError
from . import bank
from .train import Recipe, train

HELD_OUT = 100_000
"""Seeds of shapes from here on are never trained on."""


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(prog="python -m proxy_renderer.train", description=__doc__)
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("out/train"),
        help="checkpoint, log, banks and model (default: %(default)s)",
    )
    parser.add_argument(
        "--minutes", type=float, default=60, help="how long this sitting trains (default: %(default)s)"
    )
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument(
        "--views", type=int, default=1000, help="views in the training bank, when it has to be traced"
    )
    parser.add_argument("--shapes", type=int, default=250, help="shapes in it")
    parser.add_argument("--size", type=int, default=160, help="side of a picture in pixels")
    parser.add_argument("--workers", type=int, default=2, help="processes that trace")
    parser.add_argument(
        "--rate", type=float, default=Recipe.rate, help="learning rate; lower it for the last sitting"
    )
    parser.add_argument("--groups", type=int, default=Recipe.groups, help="groups of four pictures per step")
    parser.add_argument("--seed", type=int, default=Recipe.seed)
    parser.add_argument(
        "--evaluate", type=Path, nargs="*", metavar="MESH", help="judge the model, also on these meshes"
    )
    options = parser.parse_args()
    try:
        _run(options)
    except VibeError as error:
        parser.exit(2, f"{error}\n")


def _run(options: argparse.Namespace) -> None:
    places = {
        options.out / "bank": (options.views, options.shapes, 0),
        options.out / "heldout": (240, 48, HELD_OUT),
    }
    for folder, (views, shapes, first) in places.items():
        if not folder.exists():
            print(f"tracing {views} views of {shapes} shapes into {folder}", flush=True)
            bank.build(folder, views, shapes, first, options.size, options.workers)
    recipe = Recipe(groups=options.groups, rate=options.rate, seed=options.seed)
    trainer = train(recipe, options.out / "bank", options.out, options.minutes, torch.device(options.device))
    trainer.export(options.out / "model")
    print(f"step {trainer.step}: the model is in {options.out / 'model'}", flush=True)
    if options.evaluate is not None:
        from .evaluate import evaluate

        evaluate(
            options.out / "model", options.out / "heldout", options.evaluate, options.out / "results.json"
        )


if __name__ == "__main__":
    main()
