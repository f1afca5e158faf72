# SPDX-License-Identifier: Apache-2.0
"""All pairs of look words and targets of a prompt, with their features: what is scored, and what is fitted."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from ...color.floats import chroma, lab_from_srgb
from ..lexer import Lexer
from ..lexicon.vocabulary import Vocabulary
from ..mentions.changes import with_changes
from ..mentions.find import mentions
from ..mentions.nouns import NounMention
from ..mentions.passage import Passage, PromptLook, passage
from ..mentions.scene import SceneIndex
from ..types import SceneDescription
from .becoming import Becoming, becoming
from .clauses import ClauseForms
from .features import PairFeatures
from .own_nouns import OwnNouns
from .targets import TINGE, Target, targets

_OF_LIGHT = ("mood", "lighting", "grade", "atmosphere")
_GRAYISH = 25.0  # C* of colors that a light hardly has


@dataclass(frozen=True)
class TargetPair:
    """A look word with something that it may describe.

    Attributes:
        look: The look word.
        target: What it may describe.
        becoming: What it would be there.
        features: What can be said of the two, each once, in order: sums are the same in every process.
        names_itself: The look word is in the noun that names the target: "sunlight".
        told: Name of the target that the artist has chosen; "" where the reader has.
    """

    look: PromptLook
    target: Target
    becoming: Becoming
    features: tuple[str, ...]
    names_itself: bool = False
    told: str = ""


@dataclass(frozen=True)
class PromptPairs:
    """A prompt with its open questions.

    Attributes:
        passage: Its tokens and look words.
        mentions: Its nouns.
        pairs: Of each look word, in the order of the passage's.
    """

    passage: Passage
    mentions: list[NounMention]
    pairs: list[list[TargetPair]]


def looks(
    text: str, words: SceneDescription, vocabulary: Vocabulary, foreign: Collection[str] = ()
) -> Passage:
    """A prompt with its look words, of which nothing is bound.

    Args:
        foreign: Words of another language that are left in the prompt.
    """
    clauses = with_changes(Lexer(vocabulary, words, foreign).clauses(text), vocabulary)
    return passage(clauses, vocabulary)


def reading(
    text: str, words: SceneDescription, vocabulary: Vocabulary, foreign: Collection[str] = ()
) -> PromptPairs:
    """The pairs of a prompt.

    Args:
        foreign: Words of another language that are left in the prompt.
    """
    found = looks(text, words, vocabulary, foreign)
    nouns = mentions(found, words.made(SceneIndex, vocabulary), vocabulary)
    every = targets(nouns, words)
    forms = ClauseForms(found, nouns, vocabulary)
    own, pairs = OwnNouns(found, nouns, vocabulary), []
    for look in found.looks:
        facts = PairFeatures(look, forms)
        itself = {number for number, noun in enumerate(nouns) if noun.covers(look.index)}
        may_describe = [*every, Target(TINGE)] if found.tinged(look) else every
        chosen = _meant(look, own, may_describe, nouns)
        if _is_a_tone(look, own.of(look.index), found, vocabulary):
            chosen = [target for target in every if target.kind == "picture"]
        may_be = _becomings(look, chosen, vocabulary) or _becomings(look, may_describe, vocabulary)
        pairs.append(
            [
                TargetPair(look, t, b, tuple(sorted({*facts.of(t, b)})), t.mention in itself)
                for t, b in may_be.items()
            ]
        )
    return PromptPairs(found, nouns, pairs)


def _becomings(look: PromptLook, every: list[Target], vocabulary: Vocabulary) -> dict[Target, Becoming]:
    """Targets that a look word can describe, with what it is there."""
    return {target: b for target in every if (b := becoming(look.token, target.kind, vocabulary))}


def _meant(look: PromptLook, own: OwnNouns, every: list[Target], nouns: list[NounMention]) -> list[Target]:
    """The targets of a look word; of one in a change phrase only those that its object names."""
    noun = own.changed(look.index)
    if noun is None or not noun.named:
        return every
    theirs = {number for number, each in enumerate(nouns) if each.covers(noun.start)}
    return [target for target in every if target.mention in theirs or target.kind == TINGE]


def _is_a_tone(look: PromptLook, noun: NounMention | None, found: Passage, vocabulary: Vocabulary) -> bool:
    """Whether a color is the tone of the picture: "everything is pink", "all gold and lazy", and nobody paints it so."""
    words, color = vocabulary.words, look.token.color
    if not color or noun is None or noun.text not in words["everything"] or noun.spared:
        return False
    done = words["paints"] | words["changes"]
    spares = vocabulary.lists["save"] | vocabulary.lists["exception"] | vocabulary.lists["refusal"]
    clause = [item for item in found.items if item.clause == found.items[look.index].clause]
    told = any(i.text in words["copulas"] or vocabulary.slot(i.entry) in _OF_LIGHT for i in clause)
    acts = any(item.text in done | spares for item in found.items)
    return told and not acts and chroma(lab_from_srgb(color)) > _GRAYISH
