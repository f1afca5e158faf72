# SPDX-License-Identifier: Apache-2.0
"""Words that speak of no look are not acted on."""

import pytest
from ordinary_prompts import share_of_false_actions

MOST = 0.02
"""Share of all words on which the reader may act falsely."""


@pytest.mark.parametrize("half", ["chosen_on", "reported_on"])
def test_ordinary_words_change_nothing(half):
    assert share_of_false_actions(half) <= MOST
