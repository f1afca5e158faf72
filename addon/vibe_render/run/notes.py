# SPDX-License-Identifier: GPL-3.0-or-later
"""An engine's report in lines for people: words, the vision-language model's part, checked frames. No bpy here."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

_MOST = 4  # most frames that a search takes in addition to its own


@dataclass(frozen=True)
class CheckedFrame:
    """A frame that was rendered to check that the words of a look are visible there, too."""

    frame: int
    # words that are visible at the frame where the look was found, and not at this one
    lost: list[str] = field(default_factory=list)
    verdicts: list[dict[str, str]] = field(default_factory=list)  # as in `messages.Finished`
    note: str = ""  # the reason if nothing could be measured
    picture: Path | None = None  # the render with the look


def words_of(verdicts: Sequence[Mapping[str, str]], state: str) -> list[str]:
    """The words whose verdict has the state `state`: "visible", "already", "unmeasured" or "missed"."""
    return [row["word"] for row in verdicts if row["state"] == state and row["word"]]


def verdict_lines(verdicts: Sequence[Mapping[str, str]]) -> list[str]:
    """A line with the words of each state, such as "visible", and a line with the `shortfall` of each missed word."""
    names = {"visible": "The picture shows", "already": "Was so already", "unmeasured": "Set, not measured"}
    by_state = {name: words_of(verdicts, state) for state, name in names.items()}
    lines = [f"{name}: {', '.join(words)}." for name, words in by_state.items() if words]
    missed = [row for row in verdicts if row["state"] == "missed"]
    lines += [f"It does not show '{row['word']}': {shortfall(row)}." for row in missed if row["word"]]
    return lines + [f"Look at the subject: {row['missing']}." for row in missed if not row["word"]]


def shortfall(row: Mapping[str, str]) -> str:
    """The lack of a missed word, and the cause: "color is #74726f, wanted #ce371f; it conflicts with 'night'"."""
    return "; ".join(filter(None, (row["missing"], row["why"])))


def word_notes(report: Mapping[str, Any]) -> list[str]:
    """Lines on words that were left out or guessed, and on contradictions; `report` is the content of report.json."""
    understood = report.get("understood", {})
    ignored = ", ".join(dict.fromkeys(understood.get("ignored", [])))
    guesses = [f"“{word}” was taken for “{near}”" for word, near in understood.get("guesses", {}).items()]
    return [*([f"Left out: {ignored}"] if ignored else []), *guesses, *understood.get("notes", [])]


def failure_note(report: Mapping[str, Any]) -> str:
    """A line on rounds in which the vision-language model failed and the offline planner took its place; else ""."""
    failures = report.get("vlm", {}).get("failures", [])
    if not failures:
        return ""
    rounds = report.get("rounds", [])
    alone = sum(str(r.get("advice", "")).startswith("offline planner") for r in rounds)
    return f"Planned without the model in {alone} of {len(rounds)} rounds. {failures[0]}"


def model_lines(report: Mapping[str, Any], judge: Mapping[str, Any]) -> list[str]:
    """Lines on the vision-language model: calls, tokens, cost, failures; its verdict (`judge` of `Finished`)."""
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


def lost_frames(checked: Sequence[CheckedFrame]) -> list[int]:
    """Frames where a word is lost: at most `_MOST`, evenly spread, because a search keeps all its frames in memory."""
    lost = [each.frame for each in checked if each.lost]
    return lost[:: -(-len(lost) // _MOST)] if lost else []


def steady_line(checked: Sequence[CheckedFrame]) -> str:
    """A line that all checked frames show the same words; "" if one does not, or none was checked."""
    same = bool(checked) and not any(map(frame_line, checked))
    return f"At all {len(checked)} checked frames the same words are visible." if same else ""


def frame_line(checked: CheckedFrame) -> str:
    """A line on a frame that could not be checked, or where a word is no longer visible; "" for other frames."""
    lost = f"no longer visible: {', '.join(checked.lost)}." if checked.lost else ""
    return f"Frame {checked.frame}: {checked.note or lost}" if checked.note or lost else ""
