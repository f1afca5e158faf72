# SPDX-License-Identifier: Apache-2.0
"""From a prompt and exported scenes to values: Algorithm 1 of the paper, from each start. Comments name its lines; its θ is u."""

import time
from dataclasses import replace

from .rounds.confiner import RoundStart, Start
from .rounds.refinement import Outcome, RoundEnd, least_change, nearest, next_round, outcome_of
from .rounds.search import Search
from .rounds.starts import find_starts


def run(search: Search) -> Outcome:
    """Finds the values that make the scene, or several shots of one look, look like the prompt.

    The same options give the same values, bit for bit, on a CPU. All outcomes are in the `variants` of that of least loss, where
    several are asked for. Raises VibeError if no word of the prompt is known, or nothing that the words touch may change.
    """
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
