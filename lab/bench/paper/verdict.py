# SPDX-License-Identifier: Apache-2.0
"""The rule that decides a pair, written down: what `RULE` says is what the functions do."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from lab.bench.paper.finished import FinishedPicture
from lab.bench.paper.measures import NOTICES, color_error, taken
from lab.bench.paper.pairs import Ask, Pair
from lab.bench.paper.visible import SubjectVisibility, visibility

BAND = 0.05
"""Scores that differ by less are a tie."""

_LEAST = 16  # pixels that can be measured
_COLOR_NOTICE = 2.3  # CIEDE2000, the usual just noticeable difference

RULE = (
    "Every prompt has a list of what a person reads in it, written by hand. These are development pairs: some lists, and "
    "what counts as none and as enough, were mended after pictures had been seen. "
    "Each of these asks is measured on the Cycles picture alone, and gives 0 where the picture has nothing of it, 1 where "
    "nobody would ask for more, and in between in between. Differences between the two pictures that people do not "
    "notice side by side count as none. A picture's score is the mean over its asks, times how well the subject can "
    "be seen (outline against the surroundings, anything to see within it, whole in the frame): what cannot be seen has "
    "no attributes. Scores are averaged over the seeds; the higher one wins, and less than "
    f"{BAND:g} between them is a tie. What the words leave open does not count."
)

JudgeScore = float | None


@dataclass(frozen=True)
class Reading:
    """One picture, measured.

    Attributes:
        amounts: Of each ask, in its unit.
        visible: The subject.
        judge: Similarity to the prompt gained over the artist's picture, to an encoder that nobody optimized; None
            where there is none.
    """

    amounts: tuple[float, ...]
    visible: SubjectVisibility
    judge: JudgeScore = None


@dataclass(frozen=True)
class Score:
    """The score of a reading beside another.

    Attributes:
        asks: Of each ask, 0 to 1.
        mean: Over all that is asked, 0 to 1, however well the subject can be seen.
        whole: The mean times how well it can be seen.
    """

    asks: tuple[float, ...]
    mean: float
    whole: float


_JUDGE_FULL = 0.3
_JUDGE_NOTICE = 0.02


def read(pair: Pair, after: FinishedPicture, before: FinishedPicture, judge: JudgeScore = None) -> Reading:
    """Measures one picture on what its prompt asks for.

    Args:
        judge: What `Judge.gain` says; None without a judge.
    """
    amounts = tuple(_amount(ask, after, before) for ask in pair.asks)
    return Reading(amounts, visibility(after, before, pair.silhouette), judge)


def compare(pair: Pair, ours: Reading, theirs: Reading) -> tuple[Score, Score]:
    """The scores of two readings of one pair, in their order.

    Args:
        theirs: The other; differences that people do not notice count as none.
    """
    columns = [
        _pair_of(ask.trait.none, ask.trait.full, notice(ask), a, b)
        for ask, a, b in zip(pair.asks, ours.amounts, theirs.amounts, strict=True)
    ]
    judged = list(columns)
    if ours.judge is not None and theirs.judge is not None:
        judged.append(_pair_of(0.0, _JUDGE_FULL, _JUDGE_NOTICE, ours.judge, theirs.judge))
    scores = []
    for side, reading in enumerate((ours, theirs)):
        mean = sum(column[side] for column in judged) / len(judged)
        scores.append(Score(tuple(column[side] for column in columns), mean, mean * reading.visible.whole))
    return scores[0], scores[1]


def alone(pair: Pair, reading: Reading) -> Score:
    """The score of a picture that is compared with none."""
    return compare(pair, reading, reading)[0]


def decide(ours: Sequence[float], theirs: Sequence[float]) -> str:
    """Who has won a pair, by the mean scores.

    Args:
        ours: Scores from 0 to 1, one for each seed.

    Returns:
        "win", "tie" or "loss" of ours.

    Example:
        >>> decide([0.8, 0.7], [0.6, 0.6]), decide([0.62], [0.6])
        ('win', 'tie')
    """
    gap = sum(ours) / len(ours) - sum(theirs) / len(theirs)
    return "tie" if abs(gap) < BAND else "win" if gap > 0 else "loss"


def notice(ask: Ask) -> float:
    """The least difference of an ask's amount that people notice."""
    return _COLOR_NOTICE if ask.lab else NOTICES[ask.trait.measure]


def tally(verdicts: Sequence[str], tie: float = 0.0) -> dict[str, Any]:
    """Count of each, and the share of wins with its 95 % interval.

    Args:
        verdicts: "win", "tie" or "loss", see `decide`.
        tie: The part of a win that a tie counts as.

    Returns:
        `win`, `tie`, `loss`, `win_rate`, `interval`.
    """
    counts = {kind: verdicts.count(kind) for kind in ("win", "tie", "loss")}
    total, wins = len(verdicts), counts["win"] + tie * counts["tie"]
    low, high = wilson(wins, total)
    return {**counts, "win_rate": round(wins / total, 4) if total else 0.0, "interval": [round(low, 4), round(high, 4)]}


def wilson(wins: float, count: int, z: float = 1.96) -> tuple[float, float]:
    """Confidence interval of a share, 95 % by default (Wilson 1927).

    Args:
        wins: How many of them; a half for one that is half a win.
        z: Standard deviations of the interval; 1.96 for 95 %.
    """
    if not count:
        return 0.0, 1.0
    share, square = wins / count, z * z / count
    middle = share + square / 2
    half = z * math.sqrt(share * (1 - share) / count + square / (4 * count))
    return max((middle - half) / (1 + square), 0.0), min((middle + half) / (1 + square), 1.0)


def _amount(ask: Ask, after: FinishedPicture, before: FinishedPicture) -> float:
    """Measures; nothing of a trait where there is not enough of the picture's parts left to have it."""
    parts = {ask.region, "subject", "surroundings"}
    if any(picture.region(part).sum() < _LEAST for picture in (after, before) for part in parts):
        return ask.trait.none
    if ask.lab is not None:
        return color_error(after, ask.region, ask.lab)
    was = taken(ask.trait.measure, before, ask.region) if ask.trait.than_before else 0.0
    return taken(ask.trait.measure, after, ask.region) - was


def _pair_of(none: float, full: float, least: float, ours: float, theirs: float) -> tuple[float, float]:
    """Amounts of a trait in two pictures, each in [0, 1]; the same for both where nobody sees a difference."""
    if abs(ours - theirs) < least:
        ours = theirs = (ours + theirs) / 2
    a, b = (min(max(0.0, (x - none) / (full - none)), 1.0) for x in (ours, theirs))
    return a, b
