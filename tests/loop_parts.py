# SPDX-License-Identifier: Apache-2.0
"""What the optimization loop is followed with in tests."""

PROMPT = "glossy teal ball, white studio background"


class Silent:
    """Follows the loop without a word; ends it after some steps."""

    wants_looks = False

    def __init__(self, end=10**9):
        self.end, self.seen = end, []

    def stage(self, name):
        self.seen.append(name)

    def begin(self, display):
        self.first = display

    def step(self, progress, display):
        self.seen.append(progress)
        return self.stopped()

    def stopped(self):
        return len(self.seen) >= self.end

    def ask(self, request):
        raise AssertionError("nobody renders anchors here")
