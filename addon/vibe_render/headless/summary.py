# SPDX-License-Identifier: GPL-3.0-or-later
"""The results of a vibe: report.json, and closing lines. Of bpy, only the version and the file's name are read."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy

from ..core.schema_import import labels, messages, schema
from ..export.job_folder import copied_values
from ..export.notes import shortened_notes
from ..render.light_groups import LightLayer
from ..run.notes import CheckedFrame, frame_line, model_lines, steady_line, verdict_lines, word_notes
from ..scene.nodes.mix import PASS
from .scenes import ShotList

_SHOWN = 8


def report_fields(
    args: argparse.Namespace,
    shot_list: ShotList,
    result: messages.Result,
    measured: Sequence[messages.Finished],
    skipped: dict[str, str],
    seconds: dict[str, float],
) -> dict[str, Any]:
    """The content of report.json: the engine's report and Blender's. Measurements of several shots are averaged."""
    fields = dict(result.report)
    timings = {**seconds, **{f"engine: {k}": v for k, v in fields.pop("timings", {}).items()}}
    versions = {**fields.pop("versions", {}), "blender": bpy.app.version_string}
    shots = [
        {
            "name": shot.name, "scene": Path(shot.scene).stem, "blend": blend_of(args, shot_list, number),
            "camera": shot.camera, "frame": shot.frame, "before": numbered("before.png", number),
            "after": numbered("after.png", number), **_measurements([each]),
        }
        for number, (shot, each) in enumerate(zip(shot_list.shots, measured, strict=True))
    ]  # fmt: skip
    return {
        **fields,
        "scene": os.path.basename(args.scene or bpy.data.filepath) or args.command,
        "subject": sorted(shot_list.subjects[0]),
        **_measurements(measured),
        **({"shots": shots} if len(shots) > 1 else {}),
        "stopped": result.stopped,
        "not_written": skipped,
        "warnings": _warnings(shot_list, result),
        "timings": {**timings, "total": round(sum(seconds.values()), 2)},
        "versions": versions,
    }


def light_rows(file: str, layers: Sequence[LightLayer]) -> dict[str, dict[str, list[str]]]:
    """File name -> pass name -> names of its lights, for a file of light layers; empty without layers."""
    rows = {PASS + layer.name: [member.name for member in layer.members] for layer in layers}
    return {file: rows} if rows else {}


def blend_of(args: argparse.Namespace, shot_list: ShotList, number: int) -> str:
    """The name of the .blend that a shot is saved in: its own with `--grade-each`, else its scene's."""
    scenes = list(dict.fromkeys(args.scenes))
    return numbered("vibed.blend", number if args.grade_each else scenes.index(shot_list.shots[number].scene))


def numbered(name: str, number: int) -> str:
    """A file's name for one of several shots, from 0: "after.png", "after-2.png"."""
    stem, _, kind = name.rpartition(".")
    return f"{stem}-{number + 1}.{kind}" if number else name


def _measurements(measured: Sequence[messages.Finished]) -> dict[str, Any]:
    """Means of the shots' measurements, and the first shot's claims and verdicts; `delta_e` is of the shown prediction."""
    rows = [each.prediction for each in measured]
    names = [name for name in rows[0] if all(name in row for row in rows)]
    prediction = {name: _mean([row[name] for row in rows]) for name in names}
    judges = [each.judge for each in measured if each.judge]
    return {
        "similarity": _mean([each.similarity for each in measured]),
        "delta_e": prediction["shown"]["mean"],
        "prediction": prediction,
        "claims": measured[0].claims,
        "verdicts": measured[0].verdicts,
        **({"judge": judges[0]} if judges else {}),
    }


def _mean(rows: Sequence[dict[str, float]]) -> dict[str, float]:
    """The mean over the rows of each key that all rows have."""
    keys = [key for key in rows[0] if all(key in row for row in rows)]
    return {key: round(sum(row[key] for row in rows) / len(rows), 4) for key in keys}


def _warnings(shot_list: ShotList, result: messages.Result) -> list[str]:
    """Notes on what the prediction leaves out, for the artist."""
    ours = [warning for job in shot_list.jobs for warning in job.warnings]
    return shortened_notes([*ours, *result.report.get("anchored", {}).get("notes", [])])


def closing_lines(
    shot_list: ShotList,
    result: messages.Result,
    measured: Sequence[messages.Finished],
    skipped: dict[str, str],
    sequence: Sequence[CheckedFrame],
) -> list[str]:
    """The lines to print at the end of a vibe; see `report_fields` for the arguments. `sequence` are checked frames."""
    values = {k: v for k, v in result.values.items() if k not in skipped}
    notes = [*word_notes(result.report)[:6], *_warnings(shot_list, result)]
    own = shot_list.jobs[0].before
    lines = [f"Note: {note}" for note in notes] + change_lines(own | copied_values(own, values), values)
    if result.variants:
        lines.append(f"{len(result.variants)} variants on variants.png; `vibe apply preset-2.json` takes the second.")
    lines += verdict_lines(measured[0].verdicts)
    lines += model_lines(result.report, measured[0].judge)
    for shot, each in zip(shot_list.shots, measured, strict=True):
        s, who = each.similarity, f"{shot.name}: " if len(shot_list) > 1 else ""
        if result.report["prompt"].strip():
            lines.append(f"{who}Similarity to the words {s['before']:.3f} -> {s['after']:.3f}.")
        error = each.prediction["shown"]
        subject = f"subject {error['subject']:.1f}, " if "subject" in error else ""
        apart = f"{error['mean']:.1f} CIEDE2000 ({subject}95th percentile {error['p95']:.1f})"
        lines.append(f"{who}The prediction differs from Cycles by {apart}.")
    lines += [line for each in sequence if (line := frame_line(each))]
    if lost := ",".join(str(each.frame) for each in sequence if each.lost):
        lines.append(f"To search one look for them too, add --steady, or --frames {lost} with the frame above.")
    return lines + [line for line in [steady_line(sequence)] if line]


def change_lines(instances: dict[str, schema.Instance], values: dict[str, Any]) -> list[str]:
    """A line for each visible change of a parameter, the largest on the perceptual scale first; at most `_SHOWN`."""
    rows = []
    for key, value in values.items():
        instance = instances.get(key)
        if instance is None:  # of an added light
            rows += [(1.0, f"{labels.title(key)}.")] if schema.light_links.link_of(key) else []
            continue
        before, after = instance.value, tuple(value)
        if labels.same(key, before, after):
            continue
        line = f"{labels.title(key)}: {labels.text(key, before)} -> {labels.text(key, after)}"
        rows.append((instance.distance(after), line))
    rows.sort(reverse=True)
    lines = [line for _, line in rows[:_SHOWN]]
    return [*lines, f"... and {len(rows) - _SHOWN} more"] if len(rows) > _SHOWN else lines
