# SPDX-License-Identifier: Apache-2.0
"""From a prompt and exported scenes to values: Algorithm 1 of the paper, from each start. Comments name its lines; its θ is u."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace

from ..guidance.encoder import Encoder
from ..planning.advice import Advisor
from ..schema.messages import Options
from .progress import Observer
from .rounds.confiner import RoundStart, Start
from .rounds.method import Method
from .rounds.refinement import Outcome, RoundEnd, least_change, nearest, next_round, outcome_of
from .rounds.search import Search
from .rounds.starts import find_starts
from .shots import ShotInput
from .stage import StagedScenes


def run(
    views: Sequence[ShotInput],
    prompt: str,
    options: Options,
    encoder: Encoder,
    observer: Observer,
    advisor: Advisor | None = None,
    stage: StagedScenes | None = None,
    method: Method | None = None,
) -> Outcome:
    """Finds the values that make the scene look like the prompt.

    Args:
        views: The exported scene; or several shots that have one look in common.
        options: Budget, seed, locks; the same options give the same values, bit for bit, on a CPU.
        observer: Follows the loop, and may end it.
        advisor: Parses, composes and confines; None for the offline planner.
        stage: The words, read against the scene, and the light that they ask for; None reads them here and adds no light.
        method: The way to search; None for the product's.

    Returns:
        The outcome of least loss; all of them are in its `variants`, where several are asked for.

    Raises:
        VibeError: If no word of the prompt is known, or nothing that the words touch may change.
    """
    search = Search(views, prompt, options, encoder, observer, advisor, stage, method)
    search.show_plan()
    outcomes = []
    for start in find_starts(search):
        outcomes.append(refine(search, start))
        if outcomes[-1].stopped:
            break
    outcomes.sort(key=lambda outcome: outcome.loss)
    return replace(outcomes[0], variants=outcomes) if search.several else outcomes[0]


def refine(search: Search, start: Start) -> Outcome:
    """The rounds from one start."""
    ends: list[RoundEnd] = []
    here: RoundStart | None = RoundStart.at(start)
    while here:  # 1: for r = 0 to R - 1
        began = time.monotonic()
        now = search.confine(here)  # 2: render, 3: parse, 4: compose, 5: confine, 7: project
        now = search.placed(now, here)
        chosen = search.select(now, now.u)  # 6: the update set S_K
        descent = search.descend(now, chosen)  # 8 to 15: T inner steps on S_K
        seconds = time.monotonic() - began
        # 16: the next θ is where the steps have led to, as Cycles has it
        ends.append(RoundEnd.seen(search, here, now, chosen, descent, seconds))
        if start.drawn is None and nearest(ends) is ends[-1]:
            search.show(ends[-1].shots, ends[-1].u)
        here = next_round(search, ends)
    return outcome_of(search, start, ends, least_change(search, ends))  # 18
