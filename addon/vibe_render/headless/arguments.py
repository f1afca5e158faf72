# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of `batch.py`. No bpy here."""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from ..core.schema_import import messages, schema

LONGEST_PROMPT = 1000
_DEFAULTS = messages.Options()
_COMMANDS = {
    "run": ("scene",),
    "demo": (),
    "export": ("scene",),
    "apply": ("preset", "scene"),
    "revert": ("scene",),
    "frames": ("scene",),
    "serve": (),
}


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise schema.VibeError(f"{message[:1].upper()}{message[1:]}.", "See `vibe run --help`.")


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """Reads the arguments that follow "--".

    The command is given either by words, as the `vibe` command does (`run SCENE...`, `demo`, `export SCENE`,
    `apply PRESET SCENE`, `revert FILE`), or by options for the file that Blender has open (`--apply PRESET`,
    `--revert`, `--demo`, `--scene FILE`). `serve` takes any number of such command lines from the standard input.

    Returns:
        A namespace with `command`, `scene` (a path, "" for the open file; `scenes` are all of them), `preset`, and
        the options.

    Raises:
        VibeError: For every mistake in them.
    """
    args = _parser().parse_args(list(argv))
    schema.budgets.fill(args)
    args.command = "revert" if args.revert else "apply" if args.preset else "demo" if args.demo else "run"
    if args.words:
        args.command = args.words[0]
        names = _COMMANDS.get(args.command)
        more = args.command == "run" and len(args.words) > 1
        if names is None or (len(args.words) != len(names) + 1 and not more):
            raise schema.VibeError(
                f"Unknown command {' '.join(args.words)!r}.", f"Use {', '.join(_COMMANDS)}."
            )
        for name, word in zip(names, args.words[1:]):  # noqa: B905  those of several follow
            setattr(args, name, word)
    args.scenes = args.words[1:] if args.command == "run" and args.words else [args.scene]
    args.cameras, args.frames = _listed(args.cameras), schema.frame_numbers(args.frames)
    if args.command in ("run", "demo"):
        _check_prompt(args.prompt)
        args.groups = _names(args.groups)
        _check_groups(args.groups, args.lock)
    if args.command not in ("revert", "serve"):
        args.out = _folder(args.out)
    return args


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="batch.py", description="Vibe Render inside Blender, without a window.")
    parser.add_argument(
        "words",
        nargs="*",
        metavar="WORD",
        help="run SCENE | demo | export SCENE | apply PRESET SCENE | revert FILE",
    )
    parser.add_argument("--events", action="store_true", help="print events for the vibe command")
    parser.add_argument("--scene", default="", help="a .blend or a mesh (default: the open file)")
    parser.add_argument(
        "--apply",
        dest="preset",
        default="",
        metavar="PRESET",
        help="apply a preset instead: a file, or a name",
    )
    parser.add_argument(
        "--revert", action="store_true", help="take every vibe out of the file again, in place"
    )
    parser.add_argument("--demo", action="store_true", help="use a scene that is built for it")
    parser.add_argument("--prompt", default="", help="the look")
    parser.add_argument("--out", type=Path, default=None, metavar="DIR", help="folder for what is written")
    parser.add_argument(
        "--cameras", action="append", default=[], metavar="A,B", help="solve for all of these"
    )
    parser.add_argument("--frames", default="", metavar="A,B-C", help="solve for these, or render these")
    parser.add_argument("--grade-each", action="store_true", help="each shot has its own grade")
    parser.add_argument("--stage", default="cyclorama", help="what a bare mesh stands on")
    parser.add_argument("--subject", action="append", default=[], metavar="NAME", help="object or collection")
    parser.add_argument("--samples", type=int, default=128, help="Cycles samples of the pictures")
    parser.add_argument("--engine", default="", metavar="PYTHON", help="Python that has the engine")
    parser.add_argument("--budget", choices=schema.BUDGETS, default="standard", help="how long to look")
    for name in (*schema.budgets.NUMBERS, "variants", "top_k", "seed"):
        default = None if name in schema.budgets.NUMBERS else getattr(_DEFAULTS, name)
        parser.add_argument(f"--{name.replace('_', '-')}", type=int, default=default)
    for name in ("encoder", "device", "baseline", "vlm_model", "vlm_url"):
        parser.add_argument(f"--{name.replace('_', '-')}", default=getattr(_DEFAULTS, name))
    parser.add_argument(
        "--no-anchor", dest="anchor", action="store_false", help="no Cycles pictures meanwhile"
    )
    parser.add_argument("--groups", action="append", default=[], metavar="A,B", help="only these may change")
    parser.add_argument("--lock", action="append", default=[], metavar="PATTERN", help="leave this alone")
    return parser


def engine_options(args: argparse.Namespace, free_camera: bool, online: bool) -> messages.Options:
    """The options of a vibe; the camera is free for bare meshes, or if it is among the groups.

    Args:
        args: The command line.
        free_camera: Whether the scene is a bare mesh.
        online: Whether other computers may be reached.
    """
    names = (
        *schema.budgets.NUMBERS,
        "variants",
        "top_k",
        "seed",
        "encoder",
        "device",
        "baseline",
        "vlm_model",
        "vlm_url",
        "anchor",
        "grade_each",
    )
    chosen = {name: getattr(args, name) for name in names}
    return messages.Options(
        **chosen, groups=tuple(args.groups), lock=tuple(args.lock), camera=free_camera, online=online
    )


def arguments_of_process() -> list[str]:
    """What follows "--" where Blender runs this file, everything where Python does."""
    return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:]


def _check_prompt(prompt: str) -> None:
    if not prompt.strip():
        raise schema.VibeError("The prompt is empty.", 'Describe the look: --prompt "misty, cool blue fog".')
    if len(prompt) > LONGEST_PROMPT:
        raise schema.VibeError(
            f"The prompt has {len(prompt)} characters, more than {LONGEST_PROMPT}.",
            "A sentence or two is best.",
        )


def _names(given: Sequence[str]) -> list[str]:
    return [name for part in given for name in re.split(r"[,\s]+", part) if name]


def _listed(given: Sequence[str]) -> list[str]:
    """Names from "A,B" lists; a name may hold spaces."""
    return list(dict.fromkeys(name.strip() for part in given for name in part.split(",") if name.strip()))


def _check_groups(groups: Sequence[str], locks: Sequence[str]) -> None:
    listed = ", ".join(schema.GROUPS)
    for name in groups:
        if name not in schema.GROUPS:
            raise schema.VibeError(f"Unknown group {name!r}.", f"Use some of: {listed}.")
    for pattern in locks:
        head = pattern.partition("/")[0]
        if head not in schema.GROUPS and not any(c in head for c in "*?["):
            raise schema.VibeError(
                f"The lock {pattern!r} can match nothing.", f"Start it with one of: {listed}."
            )


def _folder(path: Path | None) -> Path:
    """The output folder, which exists now and can be written."""
    if path is None:
        raise schema.VibeError("There is no output folder.", "Say where with --out DIR.")
    path = path.expanduser().absolute()
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            return path
    except OSError as error:
        raise schema.VibeError(
            f"The folder {path} cannot be written.", "Choose another with --out."
        ) from error
