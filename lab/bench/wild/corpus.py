# SPDX-License-Identifier: Apache-2.0
"""Runs a vibe on every scene of a folder, and makes a table and contact sheets of what came of it.

Half of the files are held out: which, the hash of their names says, so that nobody can choose. Faults are looked
for in the other half only.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from PIL import Image

from lab.bench.options import HALVES
from lab.bench.sheet import Strip, save_sheets
from lab.bench.wild import table
from lab.bench.wild.trial import Trial
from proxy_renderer.inputs.check import SCENES, file
from proxy_renderer.schema import VibeError, atomic

PROMPTS = (
    "warm golden hour, long soft shadows",
    "cold blue moonlight, dark, slight vignette",
    "glossy deep red, bright studio light",
    "thick white fog, pale and quiet",
    "noir, high contrast black and white",
    "emerald green, soft light from the left",
    "matte navy blue, warm lamp light",
    "polished gold, dark background",
)
"""Prompts of scenes that have none of their own; the hash of its name chooses."""


def run(
    out: Path,
    scenes: str,
    half: str = "development",
    listed: str = "",
    prompt: str = "",
    only: str = "*",
    size: int = 256,
) -> dict[str, Any]:
    """Measures, prints the table, and writes OUT/results.json and the contact sheets.

    A scene that has been measured already is not run again: an interrupted measurement goes on.

    Args:
        out: The folder. OUT/runs/NUMBER-NAME keeps the files of each run.
        scenes: The folder of the scenes, searched with all folders in it.
        half: One of `HALVES`.
        listed: A file with the paths of the scenes that count; "" for all.
        prompt: For all scenes; "" for one of `PROMPTS` each.
        only: A pattern of paths below the folder.
        size: Longer side of the pictures, pixels.

    Returns:
        The content of results.json.

    Raises:
        VibeError: There is no such folder, or no scene in it.
    """
    rows = {}
    chosen = [name for name in names(Path(scenes), only, listed) if half in ("all", half_of(name))]
    for number, name in enumerate(chosen, 1):
        trial = Trial(Path(scenes) / name, prompt or prompt_of(name), out / "runs" / _folder(name), size)
        rows[name] = trial.row()
        print(f"[{number}/{len(chosen)}] {name}: {table.line(rows[name])}", flush=True)
    results = table.summary(rows) | {"half": half, "size": size}
    save_sheets([_strip(name, row, out / "runs" / _folder(name)) for name, row in rows.items()], out)
    atomic.write_text(out / "results.json", json.dumps(results, indent=1))
    table.show(results)
    return results


def names(folder: Path, only: str = "*", listed: str = "") -> list[str]:
    """The scenes below a folder, as paths relative to it, in order.

    Args:
        folder: Searched with all folders in it.
        listed: A file with a path in each line that counts, comments after "#"; "" for all scenes.

    Raises:
        VibeError: There are none, or one that is listed is missing.
    """
    if not folder.is_dir():
        raise VibeError(f"There is no folder {folder}.", "Name the folder of the scenes with --scenes.")
    found = [p.relative_to(folder).as_posix() for p in folder.rglob("*") if p.suffix.lower() in SCENES]
    wanted = _listed(file(listed, "list")) if listed else found
    if missing := sorted(set(wanted) - set(found)):
        raise VibeError(f"{missing[0]} is not below {folder}.", "Take it out of the list, or get the scene.")
    chosen = sorted(name for name in wanted if fnmatchcase(name, only))
    if not chosen:
        raise VibeError(f"No scene below {folder} has a name like {only!r}.", f"Use one of: {' '.join(SCENES)}.")
    return chosen


def _listed(path: Path) -> list[str]:
    lines = (line.partition("#")[0].strip() for line in path.read_text(encoding="utf-8").splitlines())
    return [line for line in lines if line]


def half_of(name: str) -> str:
    """ "development" or "held-out", by a scene's path below the folder."""
    return HALVES[_hash(name) % 2]


def prompt_of(name: str) -> str:
    """One of `PROMPTS`, by a scene's path below the folder."""
    return PROMPTS[_hash(name) // 2 % len(PROMPTS)]


def _hash(name: str) -> int:
    return int.from_bytes(hashlib.sha256(name.encode()).digest()[:4], "big")


def _folder(name: str) -> str:
    return f"{_hash(name):08x}-{Path(name).stem[:40]}"


def _strip(name: str, row: dict[str, Any], folder: Path) -> Strip:
    pictures = ("before", "predicted", "after")
    panels = [(each, _opened(folder / "out" / f"{each}.png")) for each in pictures]
    shown = [(label, picture) for label, picture in panels if picture is not None]
    title = f"{name[-64:]}   {table.line(row)}"[:110]
    return Strip(title, _note(row)[:130], shown or [("no picture", Image.new("RGB", (256, 256), (60, 20, 20)))])


def _note(row: dict[str, Any]) -> str:
    warnings: Iterable[str] = row.get("warnings", ())
    return f"{row['prompt']}   {row['error'] or '; '.join(warnings)}"


def _opened(path: Path) -> Image.Image | None:
    if not path.is_file():
        return None
    with Image.open(path) as picture:
        return picture.convert("RGB")
