# SPDX-License-Identifier: Apache-2.0
"""A TOML file that remembers on which line things are, so that mistakes in it can be found."""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

from ...schema import VibeError

_KEY = re.compile(r"\s*([^=#\[\]{},]+?)\s*=")
_TABLE = re.compile(r"\s*\[.*\]\s*(#.*)?$")


class TomlSource:
    """A TOML file.

    Attributes:
        path: Where it is, as it was named.
        content: What it says.

    Raises:
        VibeError: It cannot be read, or is not TOML; names the line.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            text = path.read_text("utf-8")
            self.content: dict[str, Any] = tomllib.loads(text)
        except (OSError, UnicodeDecodeError) as error:
            raise VibeError(f"{path} cannot be read: {error}.", "Save it as UTF-8 text.") from error
        except tomllib.TOMLDecodeError as error:
            line = re.search(r"line (\d+)", str(error))
            where = f"line {line.group(1)}" if line else "its last line"
            reason = re.sub(r" \(at .*\)$", "", str(error))
            raise VibeError(f"{path}, {where}: this is not TOML ({reason}).", "Mend that line.") from error
        self._lines = text.splitlines()

    def line(self, *keys: str, quoted: str = "") -> int:
        """The number, from 1, of the line that has a key; or of the first one after it with a text.

        Args:
            *keys: From the outermost table to the key; tables of a list, [[shots]], are counted: "shots", "0", "frames".
            quoted: The text that is looked for.
        """
        table: tuple[str, ...] = ()
        counts: Counter[tuple[str, ...]] = Counter()
        for number, line in enumerate(self._lines):
            if _TABLE.match(line):
                table = place = _names(line)
                if line.lstrip().startswith("[["):
                    table = place = (*table, str(counts[table]))
                    counts[table[:-1]] += 1
            elif key := _KEY.match(line):
                place = table + _names(f"{key.group(1)} = 0")
            else:
                continue
            if place[: len(keys)] == keys:
                return 1 + self._of_text(quoted, number)
        return 1

    def _of_text(self, text: str, first: int) -> int:
        """The place of the line, from a first one on, that has a text in quotes; the first one where none has."""
        rest = range(first, len(self._lines))
        quoted = (f'"{text}"', f"'{text}'")
        return next((i for i in rest if text and any(q in self._lines[i] for q in quoted)), first)

    def problem(self, what: str, remedy: str, *keys: str, quoted: str = "") -> VibeError:
        """An error that names the file and the line of a key; the caller raises it.

        Args:
            keys: The way to the key, from the outermost table on.
            quoted: A text in the key's value whose line is meant, such as one pattern of a list.
        """
        return VibeError(f"{self.path}, line {self.line(*keys, quoted=quoted)}: {what}", remedy)


def _names(line: str) -> tuple[str, ...]:
    """The names in a table's head, or in a key; none if it is something else after all."""
    try:
        content = tomllib.loads(line)
    except tomllib.TOMLDecodeError:
        return ()
    names = []
    while isinstance(content, dict) and content:
        names.append(next(iter(content)))
        content = content[names[-1]]
        content = content[0] if isinstance(content, list) and content else content
    return tuple(names)
