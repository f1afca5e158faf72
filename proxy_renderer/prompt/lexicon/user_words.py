# SPDX-License-Identifier: Apache-2.0
"""An artist's own words: a .toml file that adds entries and colors to the vocabulary, or replaces them.

    [look."brand red"]            # the same rows as in vocabulary.toml, whose head explains them
    slot = "material"
    words = "our red, house red"
    do = ["material/base_color color #c8102e !1", "material/roughness 0.1..0.2 !2"]

    [colors]
    "midnight plum" = "#3a1238"

Read from the file that $VIBE_VOCABULARY names (`vibe --vocabulary FILE` sets it), else from `vocabulary.toml` in the
user's configuration folder.
"""

from __future__ import annotations

import os
import re
import tomllib
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from ...color.floats import srgb_from_hex
from ...folders import config_folder
from ...schema import VibeError
from .entries import VocabularyEntry, normalize, read_entry
from .vocabulary import Vocabulary, shipped_vocabulary

VARIABLE = "VIBE_VOCABULARY"
_TABLES = {"look": "entries", "colors": "color names"}
_LARGEST = 2_000_000  # bytes; a vocabulary is text that somebody wrote


def default_vocabulary() -> Vocabulary:
    """The vocabulary that is shipped, with the user's own on top.

    Raises:
        VibeError: Something in the user's file is wrong.
    """
    path = user_file()
    return _extended(path, path.stat().st_mtime_ns) if path else shipped_vocabulary()


@cache
def _extended(path: Path, changed: int) -> Vocabulary:
    return extend(shipped_vocabulary(), path)


def user_file() -> Path | None:
    """The artist's own vocabulary; None where there is none.

    Raises:
        VibeError: $VIBE_VOCABULARY names a file that does not exist.
    """
    if named := os.environ.get(VARIABLE):
        path = Path(named).expanduser()
        if not path.is_file():
            raise VibeError(
                f"There is no vocabulary {named}.", f"Check --vocabulary, or the variable {VARIABLE}."
            )
        return path
    path = config_folder() / "vocabulary.toml"
    return path if path.is_file() else None


def extend(base: Vocabulary, path: Path) -> Vocabulary:
    """A vocabulary with a user's file on top: its words win over those of the same spelling.

    Raises:
        VibeError: Something in the file is wrong; names the file, the line and the remedy.
    """
    text, rows = _read(path)
    entries = dict(base.entries)
    for name, row in rows.get("look", {}).items():
        entries[normalize(name)] = _entry(path, text, name, row)
    synonyms = dict(base.synonyms)
    colors = dict(base.colors)
    for name in map(normalize, rows.get("look", {})):
        for word in entries[name].words:
            synonyms[word] = name
            colors.pop(word, None)
        _check_links(path, text, entries, name)
    for name, code in rows.get("colors", {}).items():
        if not isinstance(code, str) or not re.fullmatch(r"#[0-9a-fA-F]{6}", code):
            raise _problem(path, text, name, f"'{code}' is not a color", 'Write it as "#rrggbb".')
        colors[normalize(name)] = srgb_from_hex(code)
    return replace(base, entries=entries, synonyms=synonyms, colors=colors)


def _read(path: Path) -> tuple[str, dict[str, Any]]:
    try:
        if path.stat().st_size > _LARGEST:
            raise VibeError(
                f"The vocabulary {path} is larger than {_LARGEST // 1_000_000} MB.", "Use a .toml of words."
            )
        text = path.read_text("utf-8")
        rows = tomllib.loads(text)
    except (OSError, UnicodeDecodeError) as error:
        raise VibeError(
            f"The vocabulary {path} cannot be read: {error}.", "Save it as UTF-8 text."
        ) from error
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"The vocabulary {path} is not valid TOML: {error}.", "Mend that line.") from error
    for table, content in rows.items():
        if table not in _TABLES or not isinstance(content, dict):
            remedy = f"Use [look.NAME] or [colors]; these hold {' and '.join(_TABLES.values())}."
            raise _problem(path, text, table, f"'{table}' is no part of a vocabulary", remedy)
    return text, rows


def _entry(path: Path, text: str, name: str, row: Any) -> VocabularyEntry:
    try:
        if not isinstance(row, dict):
            raise VibeError(f"'{name}' is not a table.", f'Write [look."{name}"] above its rows.')
        return read_entry(normalize(name), row)
    except VibeError as error:
        quoted = re.search(r"'([^']+)'", error.message)
        raise _problem(path, text, name, error.message.removeprefix("Vocabulary: ").rstrip("."), error.remedy,
                       quoted.group(1) if quoted else "") from error  # fmt: skip


def _check_links(path: Path, text: str, entries: dict[str, VocabularyEntry], name: str) -> None:
    opposite = entries[name].opposite
    if opposite and normalize(opposite) not in entries:
        raise _problem(
            path, text, name, f"'{name}' has the unknown opposite '{opposite}'", "Name an entry.", opposite
        )


def _problem(path: Path, text: str, name: str, what: str, remedy: str, quoted: str = "") -> VibeError:
    """An error that names the line: the one that holds what is quoted, at or after the entry's head."""
    lines = text.splitlines()
    head = next((i for i, line in enumerate(lines) if name in line), 0)
    line = next((i for i in range(head, len(lines)) if quoted and quoted in lines[i]), head)
    return VibeError(f"{path}, line {line + 1}: {what}.", remedy)
