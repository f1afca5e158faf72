# SPDX-License-Identifier: Apache-2.0
"""What the optimization loop is followed with in tests."""

from dataclasses import replace

from proxy_renderer.goals.resolve import goals_or_why
from proxy_renderer.optimize.rounds.search import Search
from proxy_renderer.optimize.scene_facts import described
from proxy_renderer.optimize.stage import StagedScenes
from proxy_renderer.words.parser import Understood

PROMPT = "glossy teal ball, white studio background"


class Silent:
    """Follows the loop without a word; ends it after some steps."""

    wants_looks = False

    def __init__(self, end=10**9):
        self.end, self.seen = end, []

    def stage(self, name):
        self.seen.append(name)

    def begin(self, display, lit):
        self.first = display

    def step(self, progress, display):
        self.seen.append(progress)
        return self.stopped()

    def stopped(self):
        return len(self.seen) >= self.end

    def ask(self, request):
        raise AssertionError("nobody renders anchors here")


def any_round(search, ends):
    """Another round from the last end, however near it is to the words, in the place of `next_round`."""
    last, here = ends[-1], ends[-1].confined.here
    if len(ends) == search.rounds:
        return None
    return replace(
        here, u=last.u, shots=last.shots, number=here.number + 1, earlier=last.confined.plan, share=1.0, opening=0.0
    )


def read_stage(scenes, prompt):
    """The words, read against scenes that stay as they are lit: no light is added."""
    understood = Understood(prompt, described(*scenes))
    scenes = [scene.with_copies(understood.scene.copies) for scene in scenes]
    return StagedScenes(scenes, understood, goals_or_why(understood))


def search_for(views, prompt, options, encoder, observer, advisor=None, stage=None, method=None):
    """A search for words, in scenes that stay as they are lit unless a stage is given."""
    stage = stage or read_stage([view.scene for view in views], prompt)
    return Search(views, stage, options, encoder, observer, advisor, method)
