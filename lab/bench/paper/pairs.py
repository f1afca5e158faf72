# SPDX-License-Identifier: Apache-2.0
"""The prompts with their asks, and the measured amounts behind the asks' words: `pairs.toml` and `traits.toml`."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path

from lab.bench.paper.measures import SAYS
from proxy_renderer.color.floats import chroma, lab_from_srgb, srgb_from_hex
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary

WIDER = "wider"
COMPARED = ("benchmark", WIDER)
"""Groups of which ours is compared with CLIP-only; the ablations show ours alone, as in the paper."""

_HERE = Path(__file__).parent
_ENOUGH, _WRONG = 10.0, 38.0
"""CIEDE2000 (2:1:1) up to which a region has a color's name, and from which it has not at all."""

_NEUTRAL, _TIGHT = 6.0, 0.5
"""Chroma below which a color is white, gray or black, and by how much nearer those have to be: a tint shows at once."""


@dataclass(frozen=True)
class Trait:
    """A word in measured amounts.

    Attributes:
        measure: A name in `measures.SAYS`, or "color".
        none: The amount at which a picture has nothing of it.
        full: The amount at which nobody would ask for more.
        than_before: Whether the change from the artist's picture is meant.
    """

    measure: str
    none: float
    full: float
    than_before: bool = False


@dataclass(frozen=True)
class Ask:
    """One thing that the words ask for.

    Attributes:
        region: See `FinishedPicture.region`.
        word: The trait or color.
        trait: What it means.
        lab: Of a color; None for a trait.
    """

    region: str
    word: str
    trait: Trait
    lab: tuple[float, float, float] | None = None

    @property
    def text(self) -> str:
        """As in the file."""
        return f"{self.region}: {self.word}"


@dataclass(frozen=True)
class Pair:
    """A prompt and a scene.

    Attributes:
        name: Unique.
        group: "benchmark", an ablation's name, or "wider".
        prompt: The words.
        asks: What a person reads in them.
        set: The scene's name on Blender's side; "" for a mesh.
        mesh: A file of the paper; "" for a set.
    """

    name: str
    group: str
    prompt: str
    asks: tuple[Ask, ...]
    set: str = ""
    mesh: str = ""

    @property
    def foggy(self) -> bool:
        """True if fog is measured."""
        return any(ask.trait.measure == "fog" for ask in self.asks)

    @property
    def silhouette(self) -> bool:
        """True if the subject may be an even, dark shape."""
        return any(ask.trait.measure == "silhouette" for ask in self.asks)


def read_pairs(pattern: str = "*") -> list[Pair]:
    """The pairs with such names, in the file's order.

    Raises:
        VibeError: There are none.
    """
    rows = tomllib.loads((_HERE / "pairs.toml").read_text("utf-8"))["pair"]
    chosen = [
        Pair(**{**row, "group": row.get("group", WIDER), "asks": tuple(map(read_ask, row["asks"]))})
        for row in rows
        if fnmatchcase(row["name"], pattern)
    ]
    if not chosen:
        names = ", ".join(row["name"] for row in rows)
        raise VibeError(f"No pair has a name like {pattern!r}.", f"There are: {names}.")
    return chosen


def read_ask(text: str) -> Ask:
    """An ask as `pairs.toml` writes it.

    Raises:
        VibeError: A word in it is neither a trait nor a color.
    """
    region, _, word = text.partition(": ")
    if word in _traits():
        return Ask(region, word, _traits()[word])
    colors = default_vocabulary().colors
    if word not in colors and not word.startswith("#"):
        raise VibeError(f"{word!r} in {text!r} is neither a trait nor a color.", "See traits.toml.")
    srgb = srgb_from_hex(word) if word.startswith("#") else colors[word]
    lab = lab_from_srgb(srgb)
    width = _TIGHT if chroma(lab) < _NEUTRAL else 1.0
    return Ask(region, word, Trait("color", _WRONG * width, _ENOUGH * width), lab)


@cache
def _traits() -> dict[str, Trait]:
    rows = tomllib.loads((_HERE / "traits.toml").read_text("utf-8"))["traits"]
    traits = {name: Trait(**row) for name, row in rows.items()}
    assert all(trait.measure in SAYS for trait in traits.values())
    return traits
