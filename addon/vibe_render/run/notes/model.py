# SPDX-License-Identifier: GPL-3.0-or-later
"""The vision-language model's part in a vibe, in lines for people. No bpy here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def failure_note(report: Mapping[str, Any]) -> str:
    """In how many rounds the offline planner replaced the model, and why.

    Args:
        report: The engine's report of a vibe.

    Returns:
        One line; "" if the model never failed or was not asked.
    """
    failures = report.get("vlm", {}).get("failures", [])
    if not failures:
        return ""
    rounds = report.get("rounds", [])
    alone = sum(str(r.get("advice", "")).startswith("offline planner") for r in rounds)
    return f"Planned without the model in {alone} of {len(rounds)} rounds. {failures[0]}"


def model_lines(report: Mapping[str, Any], judge: Mapping[str, Any]) -> list[str]:
    """Lines for the end of a run: calls, tokens and cost, failures, and the judge's verdict.

    Args:
        report: The engine's report of a vibe.
        judge: The verdict on before and after; empty if none was asked for.
    """
    lines = []
    if model := report.get("vlm"):
        tokens = model["tokens"]
        cost = "" if model["cost_usd"] is None else f", {model['cost_usd']:.4f} US dollars"
        lines.append(
            f"{model['model']} was asked {model['calls']} times ({model['cached']} more from the cache; "
            f"{tokens['read']} tokens read, {tokens['written']} written{cost})."
        )
        if unfit := [
            f"{model[name]} {name}" for name in ("clipped", "mended", "dropped", "missing") if model[name]
        ]:
            lines.append(f"Its answers did not fit everywhere: {', '.join(unfit)}.")
    if note := failure_note(report):
        lines.append(f"Note: {note}")
    if "winner" in judge:
        lines.append(f"The model's verdict: {judge['winner']}. {judge['reason']}".strip())
    elif "error" in judge:
        lines.append(f"Note: The model did not judge. {judge['error']}")
    return lines
