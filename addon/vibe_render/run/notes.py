# SPDX-License-Identifier: GPL-3.0-or-later
"""An engine's report of a vibe in lines for people: words that are visible, words that were left out, the model's part. No bpy here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..core.schema_import import messages


def words_shown(claims: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Word -> "" if the picture shows all that it claims, else what is missing; of words that claim something measurable.

    Args:
        claims: Rows of the report's `claims`.
    """
    by_word = messages.missing_by_word(claims)
    return {word: _missing(rows[0]) if rows else "" for word, rows in by_word.items()}


def claim_lines(claims: Sequence[Mapping[str, Any]]) -> list[str]:
    """A line for all words that the picture shows, and one for each that it does not; `claims` as for `words_shown`."""
    shown = words_shown(claims)
    visible = ", ".join(word for word, missing in shown.items() if not missing)
    lost = [_missing(row) for row in claims if not row["word"] and row["holds"] is False]
    return [
        *([f"The picture shows: {visible}."] if visible else []),
        *(f"It does not show '{word}': {missing}." for word, missing in shown.items() if missing),
        *(f"Look at the subject: {missing}." for missing in lost),
    ]


def _missing(row: Mapping[str, Any]) -> str:
    """The miss of a claim: "color of the wall is #b09080, wanted #cceede"."""
    of = "" if row["thing"] == "picture" else f" of the {row['thing']}"
    unit = f" {row['unit']}" if row["unit"] and row["measure"] != "color" else ""
    return f"{row['says']}{of} is {row['after']}{unit}, wanted {row['wanted']}"


def word_notes(report: Mapping[str, Any]) -> list[str]:
    """Words that were left out or guessed, and contradictions."""
    understood = report.get("understood", {})
    ignored = ", ".join(dict.fromkeys(understood.get("ignored", [])))
    guesses = [f"“{word}” was taken for “{near}”" for word, near in understood.get("guesses", {}).items()]
    return [*([f"Left out: {ignored}"] if ignored else []), *guesses, *understood.get("notes", [])]


def failure_note(report: Mapping[str, Any]) -> str:
    """In how many rounds the offline planner replaced the vision-language model, and why; "" if it never failed."""
    failures = report.get("vlm", {}).get("failures", [])
    if not failures:
        return ""
    rounds = report.get("rounds", [])
    alone = sum(str(r.get("advice", "")).startswith("offline planner") for r in rounds)
    return f"Planned without the model in {alone} of {len(rounds)} rounds. {failures[0]}"


def model_lines(report: Mapping[str, Any], judge: Mapping[str, Any]) -> list[str]:
    """The model's part in a vibe: calls, tokens and cost, failures, and its verdict.

    Args:
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
        kinds = ("clipped", "mended", "dropped", "missing")
        if unfit := [f"{model[kind]} {kind}" for kind in kinds if model[kind]]:
            lines.append(f"Its answers did not fit everywhere: {', '.join(unfit)}.")
    if note := failure_note(report):
        lines.append(f"Note: {note}")
    if "winner" in judge:
        lines.append(f"The model's verdict: {judge['winner']}. {judge['reason']}".strip())
    elif "error" in judge:
        lines.append(f"Note: The model did not judge. {judge['error']}")
    return lines
