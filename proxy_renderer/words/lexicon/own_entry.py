# SPDX-License-Identifier: Apache-2.0
"""Adds an entry or a color to an artist's own vocabulary, after checking all of the file with it."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from ...schema import VibeError, atomic
from .user_words import extend
from .vocabulary import shipped_vocabulary

_COLORS = re.compile(r"^\[colors\][^\n]*\n", re.MULTILINE)


def add_look(path: Path, name: str, rows: Mapping[str, str | Sequence[str]]) -> None:
    """Appends an entry.

    Args:
        path: Of the vocabulary; need not exist.
        rows: As in vocabulary.toml; empty ones are left out.

    Raises:
        VibeError: The name is taken, or the file would be wrong with it; it is as it was.
    """
    lines = [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in rows.items() if value]
    head = f"[look.{json.dumps(name, ensure_ascii=False)}]"
    _write(path, name, "\n".join([_text(path).rstrip("\n"), "", head, *lines, ""]).lstrip("\n"))


def add_color(path: Path, name: str, code: str) -> None:
    """Adds a color, see `add_look`.

    Args:
        path: Of the vocabulary; need not exist.
    """
    text, line = _text(path), f"{json.dumps(name, ensure_ascii=False)} = {json.dumps(code)}\n"
    head = _COLORS.search(text)
    begun = text[: head.end()] if head else (text.rstrip("\n") + "\n\n[colors]\n").lstrip("\n")
    _write(path, name, begun + line + (text[head.end() :] if head else ""))


def _text(path: Path) -> str:
    return path.read_text("utf-8") if path.is_file() else ""


def _write(path: Path, name: str, text: str) -> None:
    """Puts the text in the file's place if a vocabulary can be made of it."""
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
        raise VibeError(
            f"{path} cannot be written: {error}.", "Name another file with --vocabulary."
        ) from error
