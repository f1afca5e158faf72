# SPDX-License-Identifier: GPL-3.0-or-later
"""What the engine has reported of a vibe, as the panel and the command line show it. No bpy here."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ..core.schema_import import messages, verdicts

LOOKING = "Looking for the look"


class SessionStatus:
    """What the engine has reported of one vibe.

    Args:
        job: The job folder, in which the engine writes its pictures.

    Attributes:
        stage: The present stage, in words.
        progress: The newest progress message.
        before: The engine's picture of the scene as it was.
        look: The newest look that is shown in the scene before the result.
        words: Word to whether that look's picture shows it.
        preview: The newest picture of the look.
        variants: The variants, the best first, each with its picture; empty unless several were asked for.
    """

    def __init__(self, job: Path) -> None:
        self.stage = "Starting the engine"
        self.progress: messages.Progress | None = None
        self.before: Path | None = None
        self.look: messages.LookSoFar | None = None
        self.words: dict[str, bool] = {}
        self.preview: Path | None = None
        self.variants: list[tuple[messages.Variant, Path]] = []
        self._job = job
        self._result: messages.Result | None = None
        self._last_word_at = 0.0  # time of the engine's last message; 0 before it is asked
        self._stopping = False

    @property
    def fraction(self) -> float:
        """The part of the loop that is done, 0 to 1."""
        p = self.progress
        return ((p.round - 1) * p.steps + p.step) / (p.rounds * p.steps) if p else 0.0

    @property
    def asked(self) -> bool:
        """Whether the engine has been given the vibe."""
        return self._last_word_at > 0.0

    @property
    def silence(self) -> float:
        """Seconds since the engine's last message, while one is expected; otherwise 0."""
        return time.monotonic() - self._last_word_at if self.asked and not self._result else 0.0

    @property
    def can_stop(self) -> bool:
        """Whether there is a best look so far, which `stop` would take."""
        return self.progress is not None and not self._stopping

    @property
    def report(self) -> Mapping[str, Any]:
        """The fields of report.json that the engine knows; empty before the result."""
        return self._result.report if self._result else {}

    @property
    def prediction_error(self) -> float | None:
        """Mean CIEDE2000 between the last prediction and the anchor after it; None without anchors."""
        return self.report.get("anchored", {}).get("predicted")

    @property
    def anchor_notes(self) -> list[str]:
        """What went wrong with anchors, in words for the artist."""
        return self.report.get("anchored", {}).get("notes", [])

    def receive(self, message: messages.Message) -> None:
        """Takes a message of the engine's."""
        self._last_word_at = time.monotonic()
        if isinstance(message, messages.Stage):
            self.stage = message.name.capitalize()
            if message.picture:
                self.before = self._job / message.picture
        elif isinstance(message, messages.LookSoFar):
            self.look, self.words = message, message.words or self.words
            if message.picture:
                self.preview = self._job / message.picture
        elif isinstance(message, messages.Progress):
            self.progress = message
            self.stage = LOOKING
            if message.preview:
                self.preview = self._job / message.preview
        elif isinstance(message, messages.Result):
            self._result = message
            self.preview = self._job / message.prediction
            self.variants = [(v, self._job / v.picture) for v in message.variants]


def words_shown(claims: Sequence[Mapping[str, Any]]) -> dict[str, str]:
    """Word -> "" if the picture shows all that it claims, else what is missing; of words that claim something measurable.

    Args:
        claims: Rows of the report's `claims`.
    """
    by_word = verdicts.missing_by_word(claims)
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
    """What a claim misses: "color of the wall is #b09080, wanted #cceede"."""
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
