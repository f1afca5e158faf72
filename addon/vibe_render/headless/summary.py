# SPDX-License-Identifier: GPL-3.0-or-later
"""What is said of a vibe at its end: report.json, and the lines that the artist reads. No bpy calls but its version."""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy

from ..core.schema_import import labels, messages, schema
from ..session.model_notes import model_lines
from ..session.word_notes import word_notes
from .shots import Reel

_SHOWN = 8


def report(
    a: argparse.Namespace,
    reel: Reel,
    found: messages.Result,
    measured: Sequence[messages.Finished],
    skipped: dict[str, str],
    laps: Laps,
) -> dict[str, Any]:
    """The fields of report.json: the engine's, and ours. Figures of several shots are their means."""
    fields = dict(found.report)
    timings = {**laps.seconds, **{f"engine: {k}": v for k, v in fields.pop("timings", {}).items()}}
    versions = {**fields.pop("versions", {}), "blender": bpy.app.version_string}
    judges = [each.judge for each in measured if each.judge]
    return {
        **fields,
        "prompt": a.prompt,
        "scene": os.path.basename(a.scene or bpy.data.filepath) or a.command,
        "subject": sorted(reel.subjects[0]),
        "similarity": _mean([each.similarity for each in measured]),
        "delta_e": _mean([{"": each.delta_e} for each in measured])[""],
        **({"judge": judges[0]} if judges else {}),
        **({"shots": _shots(a, reel, measured)} if len(reel) > 1 else {}),
        "stopped": found.stopped,
        "not_written": skipped,
        "delta_e_others": _mean([each.others for each in measured]),
        "warnings": _warnings(reel, found),
        "timings": {**timings, "total": round(sum(laps.seconds.values()), 2)},
        "versions": versions,
    }


def _shots(a: argparse.Namespace, reel: Reel, measured: Sequence[messages.Finished]) -> list[dict[str, Any]]:
    """What became of each of several shots, and where its pictures are."""
    return [
        {
            "name": shot.name,
            "scene": Path(shot.scene).stem,
            "blend": blend_of(a, reel, number),
            "camera": shot.camera,
            "frame": shot.frame,
            "before": numbered("before.png", number),
            "after": numbered("after.png", number),
            "similarity": each.similarity,
            "delta_e": each.delta_e,
            **({"judge": each.judge} if each.judge else {}),
        }
        for number, (shot, each) in enumerate(zip(reel.shots, measured, strict=True))
    ]


def blend_of(a: argparse.Namespace, reel: Reel, number: int) -> str:
    """The name of the .blend that a shot is saved in: with a grade for each, its own; else its scene's."""
    scenes = list(dict.fromkeys(a.scenes))
    return numbered("vibed.blend", number if a.grade_each else scenes.index(reel.shots[number].scene))


def numbered(name: str, number: int) -> str:
    """A file's name for one of several shots, from 0: "after.png", "after-2.png"."""
    stem, _, kind = name.rpartition(".")
    return f"{stem}-{number + 1}.{kind}" if number else name


def _mean(rows: Sequence[dict[str, float]]) -> dict[str, float]:
    return {key: round(sum(row[key] for row in rows) / len(rows), 4) for key in rows[0]}


def _warnings(reel: Reel, found: messages.Result) -> list[str]:
    """What the prediction lacks, in words for the artist."""
    ours = [warning for job in reel.jobs for warning in job.warnings]
    return list(dict.fromkeys([*ours, *found.report.get("anchored", {}).get("notes", [])]))


def summary(
    reel: Reel, found: messages.Result, measured: Sequence[messages.Finished], skipped: dict[str, str]
) -> list[str]:
    """The lines that the artist reads."""
    values = {k: v for k, v in found.values.items() if k not in skipped}
    notes = [*word_notes(found.report)[:6], *_warnings(reel, found)[:4]]
    lines = [*(f"Note: {note}" for note in notes), *listed(reel.jobs[0].instances, values)]
    if found.variants:
        lines.append(
            f"{len(found.variants)} variants on variants.png; `vibe apply preset-2.json` takes the second."
        )
    lines += model_lines(found.report, measured[0].judge)
    for shot, each in zip(reel.shots, measured, strict=True):
        s, who = each.similarity, f"{shot.name}: " if len(reel) > 1 else ""
        lines.append(
            f"{who}Similarity to the words {s['before']:.3f} -> {s['after']:.3f}; "
            f"the prediction is {each.delta_e:.1f} CIEDE2000 away from Cycles."
        )
    return lines


def listed(instances: dict[str, schema.Instance], values: dict[str, Any]) -> list[str]:
    """The changes that show, as lines; the largest on the perceptual scale first."""
    rows = []
    for key, value in values.items():
        instance = instances.get(key)
        if instance is None:  # of a light that has been added
            continue
        before, after = instance.value, tuple(value)
        if labels.same(key, before, after):
            continue
        line = f"{labels.title(key)}: {labels.text(key, before)} -> {labels.text(key, after)}"
        rows.append((instance.distance(after), line))
    rows.sort(reverse=True)
    more = [f"... and {len(rows) - _SHOWN} more"] if len(rows) > _SHOWN else []
    return [line for _, line in rows[:_SHOWN]] + more


class Laps:
    """A stopwatch: `seconds` by the name of the lap."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.monotonic()

    def lap(self, name: str) -> None:
        """Adds the seconds since the last lap to those of this name."""
        now = time.monotonic()
        self.seconds[name] = round(self.seconds.get(name, 0.0) + now - self._last, 2)
        self._last = now
