# SPDX-License-Identifier: GPL-3.0-or-later
"""The measurements of a vibe for report.json, and its closing lines."""

from collections.abc import Sequence
from typing import Any

from ..core.schema_import import labels, messages, schema
from ..export.job_folder import copied_values
from ..render.light_groups import LightLayer
from ..run.notes import CheckedFrame, frame_line, model_lines, steady_line, verdict_lines, word_notes
from ..scene.nodes.mix import PASS
from .scenes import ShotList

_SHOWN = 8  # most changes that are listed


def light_rows(file: str, layers: Sequence[LightLayer]) -> dict[str, dict[str, list[str]]]:
    """Entry of report.json for a `file` of light layers: file name -> pass -> names of its lights; {} without layers."""
    rows = {PASS + layer.name: [member.name for member in layer.members] for layer in layers}
    return {file: rows} if rows else {}


def numbered(name: str, number: int) -> str:
    """The name of a shot's file; shots count from 0: "after.png" for 0, "after-2.png" for 1."""
    stem, _, kind = name.rpartition(".")
    return f"{stem}-{number + 1}.{kind}" if number else name


def measurements(measured: Sequence[messages.Finished]) -> dict[str, Any]:
    """Fields of report.json: means of the shots' measurements, and the first shot's claims and verdicts.

    "delta_e" is the mean CIEDE2000 of the prediction that was shown.
    """
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
    keys = [key for key in rows[0] if all(key in row for row in rows)]
    return {key: round(sum(row[key] for row in rows) / len(rows), 4) for key in keys}


def closing_lines(
    shot_list: ShotList,
    result: messages.Result,
    measured: Sequence[messages.Finished],
    report: dict[str, Any],
    sequence: Sequence[CheckedFrame],
) -> list[str]:
    """The lines to print at the end of a vibe. `report`: content of report.json. `sequence`: the checked frames."""
    values = {k: v for k, v in result.values.items() if k not in report["not_written"]}
    notes = [*word_notes(report)[:6], *report["warnings"]]
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
    """A line for each visible change of a parameter, the largest on the perceptual scale first; at most `_SHOWN`.

    `instances`: the parameters with their old values, by key. `values`: the new values, by key.
    """
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
