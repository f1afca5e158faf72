# SPDX-License-Identifier: Apache-2.0
"""Checks of a vibe's options, for `vibe`, the Blender process and manifests. A mistake raises VibeError."""

import argparse
import itertools
import re
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from .. import limits
from ..errors import VibeError
from ..limits import LONGEST_PROMPT
from ..parameters import GROUPS
from .table import TABLE, TRAITS, Option


def frame_numbers(text: str) -> list[int]:
    """Frame numbers in a text such as "1,50,100-110", each once; [] for "". Raises VibeError for any other form.

    >>> frame_numbers("1, 50, 100-102, 50")
    [1, 50, 100, 101, 102]
    """
    numbers: dict[int, None] = {}
    for part in filter(None, re.split(r"[,\s]+", text)):
        match = re.fullmatch(r"(\d+)(?:-(\d+))?", part)
        if not match:
            raise VibeError(f"{part!r} names no frames.", "Write them as in 1,50,100 or 1-24.")
        first = int(match[1])
        numbers |= dict.fromkeys(range(first, int(match[2] or first) + 1))
    return list(numbers)


def prompt(text: str, like: str = "", goals: str = "", then: Sequence[str] = ()) -> str:
    """The prompt `text`, unchanged, after checks.

    Raises VibeError if all arguments are empty, if there are a prompt and `goals` (a file), or if one of the further
    sentences, `then`, is empty. The prompt and each sentence may have `LONGEST_PROMPT` characters at most.
    """
    if text.strip() and goals:
        raise VibeError("There are a prompt and goals.", "Leave out one of --prompt and --goals.")
    if not all(map(str.strip, then)):
        raise VibeError("The step is empty.", 'Say what is to change: --then "a bit warmer".')
    if not text.strip() and not like and not goals and not then:
        remedy = 'Describe the look: --prompt "misty, cool blue fog, vignette", or show it: --like still.jpg.'
        raise VibeError("The prompt is empty.", remedy)
    if (length := max(map(len, (text, *then)))) > LONGEST_PROMPT:
        remedy = "A sentence or two is best."
        raise VibeError(f"The prompt has {length} characters, more than {LONGEST_PROMPT}.", remedy)
    return text


def moments(given: argparse.Namespace) -> list[tuple[int, str]]:
    """(frame, look) pairs of `--moments`; [] without it. Raises VibeError for options that contradict moments."""
    text, markers = getattr(given, "moments", ""), getattr(given, "markers", False)
    if not (text.strip() or markers):
        return []
    name = "--moments" if text.strip() else "--markers"
    names = ["prompt", "like", "goals", "then", "frames", "grade_each", "check_every", "offset_keys"]
    names += ["markers"] if text.strip() else []
    if clash := [f"--{each.replace('_', '-')}" for each in names if getattr(given, each, None)]:
        raise VibeError(f"{name} gives the look of each frame.", f"Leave out {' and '.join(clash)}.")
    if (getattr(given, "variants", None) or 1) > 1:
        raise VibeError(f"{name} finds one look for each frame.", "Leave out --variants.")
    return timed(text) if text.strip() else []


def shots(given: argparse.Namespace, several: bool) -> None:
    """Raises VibeError for options that need a single shot if there are `several`, or that do not fit `--steady`."""
    if given.steady and not given.check_every:
        raise VibeError("--steady has no frames to hold at.", "Say which are checked: --check-every 10.")
    for name in ("then", "check_every", "offset_keys"):
        flag = f"--{name.replace('_', '-')}"
        if getattr(given, name) and given.steady and name != "check_every":
            raise VibeError(f"{flag} goes on from one frame's look.", f"Leave out {flag} or --steady.")
        if getattr(given, name) and several:
            raise VibeError(f"{flag} is for one shot.", "Leave out more scenes, --cameras and --frames.")


def timed(text: str) -> list[tuple[int, str]]:
    """(frame, look) pairs of a text "FRAME: LOOK; FRAME: LOOK". Raises VibeError for other forms, and as `in_order`.

    >>> timed("1: noon; 120: the cup: copper, at dusk")
    [(1, 'noon'), (120, 'the cup: copper, at dusk')]
    """
    found: list[tuple[int, str]] = []
    for part in filter(str.strip, text.split(";")):
        match = re.fullmatch(r"\s*(-?\d+)\s*:\s*(\S.*?)\s*", part, re.DOTALL)
        if not match:
            remedy = 'Write FRAME: LOOK; FRAME: LOOK, as in "1: noon; 120: golden hour".'
            raise VibeError(f"{part.strip()!r} is no frame with a look.", remedy)
        found.append((int(match[1]), prompt(match[2])))
    return in_order(found)


def in_order(found: list[tuple[int, str]]) -> list[tuple[int, str]]:
    """The (frame, look) pairs, unchanged. Raises VibeError unless they are at least two, with ascending frames."""
    if len(found) < 2:
        remedy = "Add a second one, or use --prompt with --frames."
        raise VibeError("There is only one moment." if found else "There are no moments.", remedy)
    for (first, _), (second, look) in itertools.pairwise(found):
        if second <= first:
            message = f"Frame {second}, {look!r}, does not come after frame {first}."
            raise VibeError(message, "Write the moments in the order of their frames, each frame once.")
    return found


def numbers(given: argparse.Namespace, table: Iterable[Option] = TABLE) -> None:
    """Sets numbers that are None to those of the effort. Raises VibeError for a number outside its option's bounds."""
    for name in limits.NUMBERS if hasattr(given, "effort") else ():
        if getattr(given, name, 0) is None:
            setattr(given, name, getattr(limits.BUDGETS[given.effort], name))
    for option in table:
        value = getattr(given, option.name, None)
        if option.bounds and value is not None and not option.bounds[0] <= value <= option.bounds[1]:
            low, high = option.bounds
            raise VibeError(f"{option.flag} {value} is out of range.", f"Use {low} to {high}.")


def _listed(given: Sequence[str], known: Sequence[str], problem: str) -> list[str]:
    """The names in texts such as "a,b", each once. Raises VibeError, with the message `problem`, for an unknown one."""
    names = list(dict.fromkeys(name for part in given for name in re.split(r"[,\s]+", part) if name))
    for name in names:
        if name not in known:
            raise VibeError(problem.format(repr(name)), f"Use some of: {', '.join(known)}.")
    return names


def groups(given: Sequence[str]) -> list[str]:
    """Parameter groups in texts such as "a,b", each once. Raises VibeError for unknown groups, or texts without any."""
    names = _listed(given, GROUPS, "Unknown group {}.")
    if given and not names:
        raise VibeError("--groups names no group.", f"Use some of: {', '.join(GROUPS)}.")
    return names


def traits(given: Sequence[str], like: str) -> list[str]:
    """Traits in texts such as "a,b", each once. Raises VibeError for unknown ones, or without an image, `like`."""
    names = _listed(given, TRAITS, "--like-only cannot be {}.")
    if names and not like:
        raise VibeError("--like-only speaks of a picture, and there is none.", "Name it: --like still.jpg.")
    return names


def locks(patterns: Sequence[str]) -> None:
    """Raises VibeError for a lock pattern that can match in no scene; matches in the present scene are not checked."""
    for pattern in patterns:
        head = pattern.partition("/")[0]
        if head not in GROUPS and not any(c in head for c in "*?["):
            remedy = f"Start it with a group ({', '.join(GROUPS)}) or a *, as in light/Key or */roughness."
            raise VibeError(f"The lock {pattern!r} can match nothing.", remedy)


def targets(pairs: Iterable[str]) -> dict[str, str]:
    """Word -> target that it describes, from texts "WORD=TARGET"; raises VibeError for others. Unknown names pass."""
    found = {}
    for pair in pairs:
        word, _, target = pair.partition("=")
        if not (word.strip() and target.strip()):
            raise VibeError(f"The target {pair!r} says nothing.", "Write WORD=TARGET, as in --target copper=Cup.")
        found[word.strip()] = target.strip()
    return found


def folder(path: Path) -> Path:
    """The absolute path of an output folder, made if missing; raises VibeError if it cannot be written."""
    path = path.expanduser()
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            pass
    except OSError as error:
        problem = f"The folder {path} cannot be written ({error.strerror or type(error).__name__})."
        raise VibeError(problem, "Choose another with --out.") from error
    return path.resolve()
