# SPDX-License-Identifier: Apache-2.0
"""Words that are no looks, and on which the reader acts all the same: the prompts of ordinary_words.toml."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from proxy_renderer.words.lexicon.entries import normalize
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.parser import prepared
from proxy_renderer.words.reader import read_words
from proxy_renderer.words.types import LightDescription, SceneDescription

FILE = Path(__file__).parent / "words" / "ordinary_words.toml"
ROOM = SceneDescription(
    "Chair",
    {"Chair": "subject", "Table": "surroundings", "Wall": "surroundings", "Floor": "surroundings"},
    {"Seat": "subject", "Wood": "surroundings", "Plaster": "surroundings", "Tiles": "surroundings"},
    {"Chair": ("Seat",), "Table": ("Wood",), "Wall": ("Plaster",), "Floor": ("Tiles",)},
    {"Key": LightDescription("AREA", "key", -50.0), "Fill": LightDescription("AREA", "fill", 60.0)},
)
_LOOK = re.compile(r"\[([^]]*)\]")


def prompts(half: str) -> list[str]:
    """The prompts of a half: "chosen_on" or "reported_on"."""
    rows: dict[str, list[str]] = tomllib.loads(FILE.read_text("utf-8"))
    return rows[half]


def words_of(text: str) -> list[str]:
    """The words of a prompt."""
    return re.findall(r"[a-z0-9']+", normalize(text))


def false_actions(marked: str) -> list[str]:
    """Look words that the reader binds to something, and none of whose words is marked as a look."""
    looks = {word for said in _LOOK.findall(marked) for word in words_of(said)}
    text = marked.replace("[", "").replace("]", "")
    reading = read_words(prepared(text, ROOM, shipped_vocabulary()), ROOM, shipped_vocabulary())
    unused = reading.parsed.ignored
    acted = (p.look for p in reading.chosen if p.target.kind != "none" and p.look.text not in unused)
    return [look.token.text for look in acted if looks.isdisjoint(words_of(look.token.text))]


def share_of_false_actions(half: str) -> float:
    """Share of all words of a half's prompts on which the reader acts falsely."""
    every = [word for text in prompts(half) for word in words_of(text)]
    false = [word for text in prompts(half) for said in false_actions(text) for word in words_of(said)]
    return len(false) / len(every)
