# SPDX-License-Identifier: GPL-3.0-or-later
"""The command line of batch.py: its arguments, and what it prints. No bpy here."""

import argparse
import json
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, NoReturn

from ..core.schema_import import checks, errors, messages, options, schema

_COMMANDS = {  # command -> the words that follow it
    "run": ("scene",), "demo": (), "export": ("scene",), "apply": ("preset", "scene"), "revert": ("scene",),
    "frames": ("scene",), "serve": (),
}  # fmt: skip


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise schema.VibeError(f"{message[:1].upper()}{message[1:]}.", "See `vibe run --help`.")


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """Parses the arguments that follow "--"; raises VibeError for every mistake in them.

    The command is given either by words, as the `vibe` command does (`run SCENE...`, `demo`, `export SCENE`,
    `apply PRESET SCENE`, `revert FILE`), or by options for the file that Blender has open (`--apply PRESET`,
    `--revert`). `serve` takes any number of such command lines from the standard input.
    In the result, `scene` is the first scene's path ("" for the open file) and `scenes` are the paths of all.
    """
    args = _parser().parse_args(list(argv))
    args.command = "revert" if args.revert else "apply" if args.preset else "run"
    args.scene = ""
    if args.words:
        args.command = args.words[0]
        names = _COMMANDS.get(args.command)
        more = args.command == "run" and len(args.words) > 1
        if names is None or (len(args.words) != len(names) + 1 and not more):
            raise schema.VibeError(f"Unknown command {' '.join(args.words)!r}.", f"Use {', '.join(_COMMANDS)}.")
        for name, word in zip(names, args.words[1:]):  # noqa: B905  those of several follow
            setattr(args, name, word)
    args.scenes = args.words[1:] if args.command == "run" and args.words else [args.scene]
    cameras = (name.strip() for part in args.cameras for name in part.split(","))  # a name may contain spaces
    args.cameras, args.frames = list(dict.fromkeys(filter(None, cameras))), schema.frame_numbers(args.frames)
    checks.numbers(args)
    if args.command in ("run", "demo"):
        args.moments = checks.moments(args)
        if not (args.moments or args.markers):
            checks.prompt(args.prompt, args.like, args.goals, args.then)
        checks.shots(args, several=max(map(len, (args.scenes, args.cameras, args.frames))) > 1)
        args.groups = checks.groups(args.groups)
        checks.locks(args.lock)
        checks.targets(args.target)
        args.like_only = checks.traits(args.like_only, args.like)
        args.like = os.path.abspath(args.like) if args.like else ""
        args.goals = os.path.abspath(args.goals) if args.goals else ""
        args.then = list(args.then)
    if args.command not in ("revert", "serve"):
        if args.out is None:
            raise schema.VibeError("There is no output folder.", "Say where with --out DIR.")
        args.out = checks.folder(args.out)
    return args


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(prog="batch.py", description="Vibe Render inside Blender, without a window.")
    add = parser.add_argument
    add("words", nargs="*", metavar="WORD", help="run SCENE | demo | export SCENE | apply PRESET SCENE | revert FILE")
    add("--events", action="store_true", help="print events for the vibe command")
    add("--names-only", action="store_true", help="export: no textures and no world, for `vibe explain`")
    add("--apply", dest="preset", default="", metavar="PRESET", help="apply a preset instead: a file, or a name")
    add("--revert", action="store_true", help="take every vibe out of the file again, in place")
    add("--out", type=Path, default=None, metavar="DIR", help="folder for what is written")
    add("--engine", default="", metavar="PYTHON", help="Python that has the engine")
    options.add_options(parser, options.HEADINGS, [option for option in options.TABLE if option.blender])
    return parser


class Reporter:
    """Prints a run's progress: plain lines, or, with `events`, lines `VIBE {json}` for the `vibe` command."""

    def __init__(self, events: bool) -> None:
        self._events = events
        self._start = time.monotonic()
        self._round = 0
        self.doing = "starting"  # the present stage

    def stage(self, name: str) -> None:
        """Reports a new stage."""
        self.doing = name
        self._print({"type": "stage", "name": name}, f"{time.monotonic() - self._start:5.1f} s  {name}")

    def note(self, line: str) -> None:
        """Reports a note for the artist."""
        self._print({"type": "note", "line": line}, f"Note: {line}")

    def engine(self, message: messages.Message) -> None:
        """Reports a stage or progress message of the engine."""
        if isinstance(message, messages.Stage):
            self.stage(message.name)
        elif isinstance(message, messages.Progress):
            line = ""
            if message.round != self._round:
                self._round = message.round
                line = f"round {message.round} of {message.rounds}: {message.seconds_left:.0f} s left"
            self._print({"type": "progress", **asdict(message)}, line)

    def result(self, lines: list[str], stopped: bool = False, missing: Sequence[str] = ()) -> None:
        """Reports lines on the result; an event also has `stopped` (by Ctrl-C) and `missing`, the words not visible."""
        event = {"type": "result", "lines": lines, "stopped": stopped, "missing": list(missing)}
        self._print(event, "\n".join(lines))

    def error(self, error: schema.VibeError) -> None:
        """Reports an error: as an event, or else on the standard error."""
        if self._events:
            unexpected = isinstance(error, errors.UnexpectedError)
            event = {"type": "error", "message": error.message, "remedy": error.remedy}
            self._print({**event, "unexpected": unexpected}, "")
        else:
            print(f"vibe: {error}", file=sys.stderr, flush=True)

    def _print(self, event: dict[str, Any], line: str) -> None:
        if self._events:
            print(f"VIBE {json.dumps(event)}", flush=True)
        elif line:
            print(line, flush=True)
