# SPDX-License-Identifier: Apache-2.0
"""The results of a batch: a contact sheet for people, tables for programs; all rewritten as jobs end."""

import csv
import html
import json
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from ..schema import atomic
from .manifest import BatchPlan
from .store import WORDS, JobRow, Store, unwritable

FIELDS = (
    "name", "scene", "prompt", "seed", "status", *WORDS, "delta_e",
    "seconds", "seconds_loop", "seconds_cycles", "memory_gb", "attempts", "frames", "shots", "variants", "final_error", "error", "remedy", "folder",
)  # fmt: skip
FILES = {
    "before": "before.png", "after": "after.png", "compare": "compare.png",
    "blend": "vibed.blend", "preset": "preset.json", "report": "report.json",
}  # fmt: skip
_PAGE = Path(__file__).with_name("page")
_SCRIPTS = ("rows.js", "card.js", "large.js", "keys.js")
_SHARE = 0.05  # most of the time that may go into rewriting the sheet while jobs run
_SOONEST = 5.0  # seconds


class Sheet:
    """Keeps the sheet and the tables up to date."""

    def __init__(self, title: str, plan: BatchPlan, store: Store) -> None:
        self._title, self._plan, self._store = title, plan, store
        self._next = 0.0

    def update(self) -> None:
        """Writes everything anew, unless that was done a moment ago."""
        if time.monotonic() >= self._next:
            self.write()

    def write(self) -> None:
        """Writes everything anew, a row at a time. Raises VibeError if it cannot be written."""
        start = time.monotonic()
        folder = self._store.folder
        before, after = _page(self._title)
        with (
            _file(folder / "index.html") as page,
            _file(folder / "results.jsonl") as lines,
            _file(folder / "results.csv") as cells,
        ):
            table = csv.DictWriter(cells, [*FIELDS, *FILES], restval="", extrasaction="ignore")
            table.writeheader()
            page.write(before)
            for row in self._store.rows(self._plan):
                full = complete(row)
                table.writerow(full | {key: " | ".join(full[key] or []) for key in (*WORDS, "shots")})
                lines.write(json.dumps(full, ensure_ascii=False) + "\n")
                short = {k: row[k] for k in FIELDS if row.get(k) not in (None, "")}
                text = json.dumps(short, ensure_ascii=False)
                # nothing in a row can end the script that it is in
                page.write(text.replace("<", "\\u003c").replace("\u2028", "\\u2028") + ",\n")
            page.write(after)
        now = time.monotonic()
        self._next = now + max(_SOONEST, (now - start) / _SHARE)


def complete(row: JobRow) -> JobRow:
    """A row with all fields, in their order, and with the paths of its files from the results folder."""
    done = row["status"] == "done"
    files = {kind: f"{row['folder']}/{name}" if done else None for kind, name in FILES.items()}
    return {key: row.get(key) for key in FIELDS} | files


def _page(title: str) -> tuple[str, str]:
    """The page before and after its rows, all in one file: from disk, browsers load little else."""
    texts = {part.name: part.read_text("utf-8") for part in _PAGE.iterdir() if part.is_file()}
    script = "\n".join(texts[name] for name in _SCRIPTS)
    page = texts["sheet.html"].replace("{{style}}", texts["sheet.css"]).replace("{{script}}", script)
    before, after = page.replace("{{title}}", html.escape(title)).split("{{rows}}")
    return before, after


@contextmanager
def _file(path: Path) -> Iterator[TextIO]:
    """A text file that appears whole or not at all."""
    try:
        with atomic.replacing(path) as part, part.open("w", encoding="utf-8", newline="") as file:
            yield file
    except OSError as error:
        raise unwritable(path, error) from error
