# SPDX-License-Identifier: Apache-2.0
"""What a prompt says should stay as it is: "leave the cup alone", "keep the wall as it is", "the table stays"."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from .lexicon.entries import normalize
from .lexicon.spelling import any_of
from .lexicon.vocabulary import Vocabulary
from .mentions.names import parts
from .mentions.nouns import REGIONS, fit_rank, materials_of
from .mentions.scene import SceneIndex
from .types import GLOW, SceneDescription

_END = r"(?=\s*(?:[,.;:!]|and\b|but\b|while\b|$))"
_AND = re.compile(r"\s*(?:,|\band\b|\bor\b)\s*")


@dataclass(frozen=True)
class Spared:
    """A passage of a prompt that says that something stays.

    Attributes:
        text: The passage, as the prompt has it.
        kept: What stays, as `Parsed.protected` names it; empty where it names nothing of the scene.
    """

    text: str
    kept: tuple[str, ...]

    def __str__(self) -> str:
        """For people."""
        names = ", ".join(key.partition("/")[2] or key for key in self.kept)
        return f"'{self.text}': {names or 'what no word names'} stays as it is."


def without_spared(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> tuple[str, list[Spared]]:
    """A prompt without what it says should stay, and what that is.

    Args:
        vocabulary: Has the words that say so.
    """
    said, found = text.replace("’", "'"), []
    finder = _Finder(scene, vocabulary)
    for number, pattern in enumerate(vocabulary.made(_patterns)):
        for match in pattern.finditer(said):
            kept = tuple(dict.fromkeys(finder.kept(match["what"])))
            if kept or number == 0:  # "keep it warm", "the light stays soft" protect nothing
                found.append(Spared(match[0].strip(), kept))
    rest = said
    for spared in found:
        rest = rest.replace(spared.text, ",")
    return (rest if rest.strip(" ,.;") else said), found


def _patterns(v: Vocabulary) -> list[re.Pattern[str]]:
    """The ways to say that something stays; the first one says so whatever it names."""
    words = {kind: _any(v, kind) for kind in ("leave", "alone", "forbid", "keep", "stays", "stay")}
    thing = rf"(?:{any_of(v.lists['definite'])} )?[\w-]+(?: [\w-]+)?"
    one = rf"{any_of(v.lists['definite'])} [\w-]+(?: [\w-]+)?"
    alone = rf"(?: {words['alone']}| put)?{_END}"
    texts = (
        rf"\b{words['leave']}\b(?P<what>[^,.;:]*?)\b{words['alone']}\b",
        rf"\b{words['forbid']} (?P<what>[^,.;:]+?){_END}",
        rf"\b{words['keep']} (?P<what>{one}){_END}",
        rf"\b(?P<what>{thing}(?:(?:,| and) {thing})+) {words['stay']}{alone}",
        rf"\b(?P<what>{one}) {words['stays']}{alone}",
    )
    return [re.compile(text, re.IGNORECASE) for text in texts]


class _Finder:
    """Finds what of a scene stays."""

    def __init__(self, scene: SceneDescription, vocabulary: Vocabulary) -> None:
        self._scene, self._vocabulary, self._index = scene, vocabulary, scene.made(SceneIndex, vocabulary)

    def kept(self, what: str) -> Iterator[str]:
        """The owners of parameters that nouns name: "material/Plaster", "light/Key", "world"."""
        for phrase in _AND.split(normalize(what)):
            plain = [w for w in phrase.split() if w not in self._vocabulary.lists["stop"]]
            noun = " ".join(w for w in plain if w not in self._vocabulary.lists["definite"])
            yield from self._named(noun) or self._of_kind(noun)

    def _named(self, noun: str) -> list[str]:
        """What is called so in the scene, in the surest way."""
        said = parts(noun) if noun else ()
        named = self._index.named(said, plural=noun.endswith("s")) if said else []
        surest = min(map(fit_rank, named), default=None)
        each = [(n.kind, name) for n in named if fit_rank(n) == surest for name in sorted(n.names)]
        return [n if k == "lights" and n.startswith(GLOW) else f"{_GROUPS[k]}/{n}" for k, n in each]

    def _of_kind(self, noun: str) -> list[str]:
        """What a general noun means: the background is what lies around, and the world; the fill is a light's role."""
        kind, roles = self._vocabulary.nouns.get(noun, ""), self._vocabulary.roles
        role = next((roles[word] for word in noun.split() if word in roles), "")
        found = [f"material/{name}" for name in sorted(materials_of(REGIONS.get(kind, ""), self._scene))]
        found += [
            f"light/{name}" for name, light in self._scene.lights.items() if role and light.role == role
        ]
        return [*found, *(["world"] if kind in ("surroundings", "sky") else [])]


_GROUPS = {"things": "material", "lights": "light"}


def _any(v: Vocabulary, kind: str) -> str:
    return any_of(v.words[kind])
