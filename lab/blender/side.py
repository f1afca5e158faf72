# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of a measurement, whatever it measures: its options, its loop over scenes, its cache, its end.

It prints lines `VIBE {json}`: "names", then "begin" before each scene, and "scene" or "failed" after it.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import sys
import traceback
from collections.abc import Callable, Mapping
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, NoReturn, TypeVar

T = TypeVar("T")


def main(
    scenes: Mapping[str, T] | Callable[[argparse.Namespace], Mapping[str, T]],
    make: Callable[[T, argparse.Namespace], dict[str, Any]],
) -> NoReturn:
    """Makes the scenes one after another; a failure of one is reported and the next one follows.

    Args:
        scenes: All scenes of this measurement by name, or what finds them by the options.
        make: Makes one scene and returns its report.
    """
    options = _arguments()
    end(_run(scenes(options) if callable(scenes) else scenes, make, options))


def once(make: Callable[[], dict[str, Any]]) -> int:
    """Does one thing and tells of it, as "scene" or as "error"; returns the exit code.

    Args:
        make: What is done; it returns what is told.
    """
    try:
        say("scene", **make())
    except Exception as error:
        traceback.print_exc()
        say("error", message=str(error))
        return 2
    return 0


def end(status: int) -> NoReturn:
    """Ends this process at once with an exit code."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(status)  # Blender 4.5's own exit handlers may wait for ever


def cached(a: argparse.Namespace, suffix: str, *settings: Any) -> Path:
    """The path of a picture in the cache, which is made if it is missing.

    Args:
        a: The options of `main`.
        *settings: All that the picture depends on.
    """
    a.cache.mkdir(parents=True, exist_ok=True)
    text = " ".join(map(str, settings))
    return a.cache / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}{suffix}"


def _run(
    scenes: Mapping[str, T], make: Callable[[T, argparse.Namespace], dict[str, Any]], a: argparse.Namespace
) -> int:
    chosen = [name for name in scenes if fnmatchcase(name, a.only)]
    if not chosen:
        say("error", message=f"No scene has a name like {a.only!r}.", remedy=f"There are: {', '.join(scenes)}.")
        return 2
    say("names", names=chosen)
    for name in (n for n in chosen if n not in a.skip.split(",")):
        say("begin", name=name)
        try:
            say("scene", name=name, **make(scenes[name], a))
        except Exception as error:
            traceback.print_exc()
            say("failed", name=name, message=f"{type(error).__name__}: {error}")
    return 0


def say(kind: str, **content: Any) -> None:
    """Prints a message for the engine's side."""
    print(f"VIBE {json.dumps({'type': kind, **content})}", flush=True)


def _arguments() -> argparse.Namespace:
    """The options that all measurements share."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", default="*", help="pattern of names")
    parser.add_argument("--skip", default="", help="names that have been made already")
    parser.add_argument("--work", type=Path, default=Path())
    parser.add_argument("--cache", type=Path, default=Path())
    parser.add_argument("--scenes", type=Path, default=Path(), help="folder of .blend files")
    parser.add_argument("--blend", action="store_true")
    for name in ("size", "samples", "seed", "count"):
        parser.add_argument(f"--{name}", type=int, default=0)
    return parser.parse_args()
