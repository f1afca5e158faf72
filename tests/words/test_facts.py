# SPDX-License-Identifier: Apache-2.0
"""Weights and facts: no weight of the fitted model is for a fact that the reader cannot find."""

import re
import string

import pytest

from proxy_renderer.words.features import Fact
from proxy_renderer.words.lexicon.entries import SLOTS
from proxy_renderer.words.model import ALIKE, APART, shipped_weights
from proxy_renderer.words.targets import LAMPS, MATTER, NOWHERE, ROLES, UNNAMED

_SORTS = "|".join(sorted({*SLOTS, "adjective"}))
_KIND = "|".join(sorted({*MATTER, *LAMPS, *ROLES, *UNNAMED, *NOWHERE, "shadow", "highlight"}))
_TURN = "after nothing|after a clause of neither|after a clause that ends in [a-z ]+"
_VALUES = {
    "sort": f"(?:{_SORTS})(?: and name)?",
    "kind": _KIND,
    "group": f"{_KIND}|matter|lamp",
    "way": "row|own|color|otherwise|elsewhere",
    "turn": _TURN,
    "name": "|[ ]and name",
    "side": "after|before",
    "where": "(?:after|before), (?:same clause|next clause|far clause)",
    "count": "[0-4]",
    "lead": "nothing|a noun|others|'.+'(?: after (?:a look|others))?",
    "nouns": ".*",
    "beside": "[a-z ]+ (?:right )?(?:after|before)",
    "word": "'.+'(?: and name)?",
}
"""Field of a fact -> a pattern of its values; others may be any text."""


def _pattern(fact: str) -> str:
    parts = string.Formatter().parse(fact)
    return "".join(
        re.escape(text) + (f"(?:{_VALUES.get(field, '.+')})" if field else "") for text, field, _, _ in parts
    )


_FACTS = [re.compile(_pattern(fact)) for fact in Fact]
_LINKS = {f"link {apart}: {alike}" for apart in APART for alike in ALIKE}


def is_fact(name: str) -> bool:
    """Whether the reader can find a fact of this name."""
    if name.startswith("link "):
        light = re.sub(r"same, (?:[a-z]+ and )?lighting(?: and [a-z]+)?$", "same", name)
        return name in _LINKS or light in _LINKS
    return any(pattern.fullmatch(name) for pattern in _FACTS)


def test_every_weight_has_a_fact():
    assert [name for name in shipped_weights() if not is_fact(name)] == []


@pytest.mark.parametrize(
    "name",
    [
        "a color word about things",
        "before, same clause: matters",
        "link near: same",
        "things unnamed: led by",
    ],
)
def test_a_fact_that_is_called_otherwise_is_none(name):
    assert not is_fact(name)
