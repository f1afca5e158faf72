# SPDX-License-Identifier: Apache-2.0
"""An artist's own words: a .toml file that adds entries and colors to the vocabulary, or replaces them.

    [look."brand red"]            # the same rows as in vocabulary.toml, whose head explains them
    slot = "material"
    words = "our red, house red"
    wishes = ["material/base_color color #c8102e !1", "material/roughness 0.1..0.2 !2"]

    [colors]
    "midnight plum" = "#3a1238"

Read from the file that $VIBE_VOCABULARY names (`vibe --vocabulary FILE` sets it), else from `vocabulary.toml` in the
user's configuration folder.
"""

import json
import os
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from ...color.floats import is_hex, srgb_from_hex
from ...folders import config_folder
from ...schema import VibeError, atomic
from .entries import at_line, normalize, read_entry
from .vocabulary import Vocabulary, check_opposite, shipped_vocabulary

VARIABLE = "VIBE_VOCABULARY"
_TABLES = {"look": "entries", "colors": "color names"}
_QUOTED = re.compile("'([^']+)'")
_VERSIONS = 2  # of the file that are remembered
_LARGEST = 2_000_000  # bytes; a vocabulary is text that somebody wrote


def default_vocabulary() -> Vocabulary:
    """The vocabulary that is shipped, with the user's own on top. Raises VibeError if something in the user's file is wrong."""
    path = user_file()
    return _extended(path, path.stat().st_mtime_ns) if path else shipped_vocabulary()


@lru_cache(_VERSIONS)
def _extended(path: Path, changed: int) -> Vocabulary:
    return extend(shipped_vocabulary(), path)


def user_file() -> Path | None:
    """The artist's own vocabulary; None where there is none. Raises VibeError if $VIBE_VOCABULARY names no file."""
    if named := os.environ.get(VARIABLE):
        path = Path(named).expanduser()
        if not path.is_file():
            remedy = f"Check --vocabulary, or the variable {VARIABLE}."
            raise VibeError(f"There is no vocabulary {named}.", remedy)
        return path
    path = config_folder() / "vocabulary.toml"
    return path if path.is_file() else None


def extend(base: Vocabulary, path: Path) -> Vocabulary:
    """A vocabulary with a user's file on top, whose words win. Raises VibeError with file, line and remedy."""
    text, rows = _read(path)
    entries, synonyms, colors = dict(base.entries), dict(base.synonyms), dict(base.colors)
    looks = rows.get("look", {})
    for name, row in looks.items():
        with _located(path, text, name):
            if not isinstance(row, dict):
                raise VibeError(f"'{name}' is not a table.", f'Write [look."{name}"] above its rows.')
            entries[normalize(name)] = read_entry(normalize(name), row)
    for name, own in ((name, entries[normalize(name)]) for name in looks):
        with _located(path, text, name):
            check_opposite(own, entries)
        synonyms |= dict.fromkeys(own.words, own.name)
        colors = {color: srgb for color, srgb in colors.items() if color not in own.words}
    for name, code in rows.get("colors", {}).items():
        if not is_hex(str(code)):
            raise at_line(path, text, f"'{code}' is not a color", 'Write it as "#rrggbb".', name)
        colors[normalize(name)] = srgb_from_hex(code)
    return replace(base, entries=entries, synonyms=synonyms, colors=colors)


def _read(path: Path) -> tuple[str, dict[str, Any]]:
    try:
        if path.stat().st_size > _LARGEST:
            raise VibeError(f"The vocabulary {path} is larger than 2 MB.", "Use a .toml of words.")
        text = path.read_text("utf-8")
        rows = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"The vocabulary {path} is not valid TOML: {error}.", "Mend that line.") from error
    except (OSError, UnicodeDecodeError) as error:
        remedy = "Save it as UTF-8 text."
        raise VibeError(f"The vocabulary {path} cannot be read: {error}.", remedy) from error
    for table, content in rows.items():
        if table not in _TABLES or not isinstance(content, dict):
            remedy = f"Use [look.NAME] or [colors]; these hold {' and '.join(_TABLES.values())}."
            raise at_line(path, text, f"'{table}' is no part of a vocabulary", remedy, table)
    return text, rows


@contextmanager
def _located(path: Path, text: str, name: str) -> Iterator[None]:
    """Adds file and line to an error on an entry; the line is found by the words that the error quotes."""
    try:
        yield
    except VibeError as error:
        what = error.message.removeprefix("Vocabulary: ").rstrip(".")
        quoted = (said for said in _QUOTED.findall(what) if said != name)
        raise at_line(path, text, what, error.remedy, name, *quoted) from error


_COLORS = re.compile(r"^\[colors\][^\n]*\n", re.MULTILINE)


def add_look(path: Path, name: str, rows: Mapping[str, str | Sequence[str]]) -> None:
    """Appends an entry. Raises VibeError, and leaves the file as it was, if the name is taken or the entry is wrong."""
    lines = [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in rows.items() if value]
    head = f"[look.{json.dumps(name, ensure_ascii=False)}]"
    _write(path, name, "\n".join([_text(path).rstrip("\n"), "", head, *lines, ""]).lstrip("\n"))


def add_color(path: Path, name: str, code: str) -> None:
    """Adds a color, see `add_look`."""
    text, line = _text(path), f"{json.dumps(name, ensure_ascii=False)} = {json.dumps(code)}\n"
    head = _COLORS.search(text)
    begun = text[: head.end()] if head else (text.rstrip("\n") + "\n\n[colors]\n").lstrip("\n")
    _write(path, name, begun + line + (text[head.end() :] if head else ""))


def _text(path: Path) -> str:
    return path.read_text("utf-8") if path.is_file() else ""


def _write(path: Path, name: str, text: str) -> None:
    """Replaces the file by a text. Raises VibeError if the text is no vocabulary, or has the name already."""
    key = json.dumps(name, ensure_ascii=False)
    if re.search(rf"^(\[look\.)?{re.escape(key)}[\] ]", _text(path), re.MULTILINE):
        raise VibeError(f"'{name}' is in {path} already.", "Change it there, or take another name.")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic.replacing(path) as part:
            part.write_text(text, encoding="utf-8")
            try:
                extend(shipped_vocabulary(), part)
            except VibeError as error:
                raise VibeError(error.message.replace(str(part), str(path)), error.remedy) from error
    except OSError as error:
        remedy = "Name another file with --vocabulary."
        raise VibeError(f"{path} cannot be written: {error}.", remedy) from error
