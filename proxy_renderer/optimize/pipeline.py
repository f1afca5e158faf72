# SPDX-License-Identifier: Apache-2.0
"""From a prompt and exported scenes to values: the starts, and a refinement from each."""

from __future__ import annotations

from collections.abc import Sequence

from ..guidance.encoder import Encoder
from ..planning.advice import Advisor
from ..schema.messages import Options
from .progress import Observer
from .rounds.method import Method
from .rounds.refinement import Outcome as Outcome
from .rounds.refinement import Refinement
from .rounds.search import LightAsked, Search
from .rounds.trials import find_starts
from .shots import ShotInput


def run(
    views: Sequence[ShotInput],
    prompt: str,
    options: Options,
    encoder: Encoder,
    observer: Observer,
    advisor: Advisor | None = None,
    light: LightAsked | None = None,
    method: Method | None = None,
) -> Outcome:
    """Finds the values that make the scene look like the prompt.

    Args:
        views: The exported scene; or several shots that are to share one look.
        options: Budget, seed, locks; the same options give the same values, bit for bit, on a CPU.
        observer: Follows the loop, and may end it.
        advisor: Parses, composes and confines; None for the offline planner.
        light: The rig that the words ask for; None for none.
        method: How it searches; None for the product's way.

    Returns:
        The outcome of least loss; all of them are in its `variants`, where several were asked for.

    Raises:
        VibeError: If no word of the prompt is known, or nothing that the words touch may change.
    """
    search = Search(views, prompt, options, encoder, observer, advisor, light, method)
    search.show_plan()
    outcomes = []
    for start in find_starts(search):
        outcomes.append(Refinement(search, start).run())
        if outcomes[-1].stopped:
            break
    outcomes.sort(key=lambda outcome: outcome.loss)
    best = outcomes[0]
    best.recall()
    best.variants = outcomes if search.several else []
    return best
