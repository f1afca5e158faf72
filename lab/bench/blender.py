# SPDX-License-Identifier: Apache-2.0
"""Blender's side of a measurement, as a process: it builds scenes, exports them and renders references."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from typing import Any

from proxy_renderer.blender.launch import events, start
from proxy_renderer.schema import VibeError


def scenes(pattern: str, options: Sequence[str], bench: str = "fidelity") -> Iterator[dict[str, Any]]:
    """Makes the scenes whose names match and yields what Blender's side tells.

    A scene that takes Blender down is told as "failed", and Blender starts again with the next one.

    Args:
        pattern: Of names, as file names are matched.
        bench: Its name, a module of `lab.blender`.

    Yields:
        Events: first "names" with the `names` of all that match, then "scene" or "failed" for each.

    Raises:
        VibeError: Blender does not start, or no scene has such a name.
    """
    done: list[str] = []
    names: list[str] = []
    while not names or len(done) < len(names):
        before, at, tail = len(done), "", deque[str](maxlen=40)
        for event in _process(bench, ["--only", pattern, "--skip", ",".join(done), *options], tail):
            kind = event["type"]
            if kind == "error":
                raise VibeError(event["message"], event["remedy"])
            if kind == "names" and not names:
                names = event["names"]
                yield event
            elif kind == "begin":
                at = event["name"]
            elif kind in ("scene", "failed"):
                done.append(at)
                yield event
        if len(done) == len(names):
            return
        last_line = next((line.strip() for line in reversed(tail) if line.strip()), "nothing")
        if not at or (at in done and len(done) == before):
            raise VibeError(f"Blender ended unexpectedly. It said last: {last_line[:200]}", "Run `vibe doctor`.")
        if at not in done:
            done.append(at)
            yield {"type": "failed", "name": at, "message": f"Blender ended unexpectedly: {last_line[:200]}"}


def command(bench: str, *arguments: object) -> dict[str, Any]:
    """Carries out one command of Blender's side of a measurement.

    Args:
        bench: Its name, a module of `lab.blender`.

    Returns:
        The event that it ends with.

    Raises:
        VibeError: It fails.
    """
    tail = deque[str](maxlen=40)
    with start(["-m", f"lab.blender.{bench}", *map(str, arguments)]) as process:
        told = list(events(process, tail))
    if not told or told[-1]["type"] != "scene":
        last_line = next((line.strip() for line in reversed(tail) if line.strip()), "nothing")
        said = told[-1]["message"] if told else last_line
        raise VibeError(f"Blender's side of this measurement failed: {said[:200]}", "Run `vibe doctor`.")
    return told[-1]


def _process(bench: str, arguments: Sequence[str], tail: deque[str]) -> Iterator[dict[str, Any]]:
    """The events of one process; what else it prints goes to the tail. It ends with this generator."""
    process = start(["-m", f"lab.blender.{bench}", *arguments])
    try:
        yield from events(process, tail)
        process.wait()
    finally:
        process.kill()
        process.wait()
        if process.stdout:
            process.stdout.close()
