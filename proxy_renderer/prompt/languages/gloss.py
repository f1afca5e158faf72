# SPDX-License-Identifier: Apache-2.0
"""A prompt in another language, glossed: English wordings in place of the artist's, each with its place in the prompt."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace

from ..lexicon.languages import TABLES, LanguageLexicon, lexicons
from ..lexicon.spelling import folded
from ..lexicon.vocabulary import Vocabulary, shipped_vocabulary
from ..lexicon.word_table import table
from ..mentions.names import parts
from ..types import SceneDescription
from .order import ordered
from .pieces import Piece, corrected, pieces, with_particles

_WORD = re.compile(r"[^\W_]+")
_TIGHT = re.compile(r"\s+([,.;:!?])")


@dataclass(frozen=True)
class Gloss:
    """A prompt in English words.

    Attributes:
        prompt: As the artist wrote it.
        english: As it is read.
        language: That it is in; "" for English.
        pieces: What the English words stand for, in their order.
    """

    prompt: str
    english: str
    language: str = ""
    pieces: tuple[Piece, ...] = ()

    @property
    def unknown(self) -> list[str]:
        """Words that neither the language's lexicon nor English knows, nor the scene has, as the prompt says them."""
        return [
            p.english
            for p in self.pieces
            if p.kind == "unknown" and p.english.isalpha() and len(p.english) > 1
        ]


def gloss(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> Gloss:
    """A prompt as English would say it; itself where it is English, or in no language that has a lexicon.

    Args:
        scene: The names in the scene, which may be in any language.
    """
    names = scene_parts(scene)
    words = _WORD.findall(text.lower())
    if all(folded(word) in names or _is_english(word, vocabulary) for word in words):
        return Gloss(text, text)
    tried = (_Attempt(text, lexicon, names, vocabulary) for lexicon in lexicons())
    best = max(tried, key=lambda attempt: attempt.letters)
    if not best.letters:
        return Gloss(text, text)
    told = [p for p in with_particles(best.pieces, text, best.lexicon) if p.english]
    meant = [p if _is_english(p.english, vocabulary) else corrected(p, best.lexicon) for p in told]
    said = [_as_english(piece, vocabulary) for piece in ordered(meant, best.lexicon, vocabulary)]
    english_text = " ".join(piece.english for piece in said if piece.english)
    return Gloss(text, _TIGHT.sub(r"\1", english_text), best.lexicon.name, tuple(said))


class _Attempt:
    """A prompt as if it were in one language.

    Args:
        names: Parts of the names in the scene, folded.

    Attributes:
        letters: Of the words that only the language knows; 0 for an English prompt in which nothing else is a look of the language.
        pieces: What the prompt is made of.
    """

    def __init__(
        self, text: str, lexicon: LanguageLexicon, names: frozenset[str], vocabulary: Vocabulary
    ) -> None:
        self.lexicon = lexicon
        self.pieces = pieces(text, lexicon, names, vocabulary.made(_phrases))
        said = [text[p.start : p.end] for p in self.pieces]
        both = [(p, _is_english(words, vocabulary)) for p, words in zip(self.pieces, said, strict=True)]
        mine = [p for p, is_english in both if p.kind in TABLES and not is_english]
        theirs = [p for p, is_english in both if p.kind == "phrase" or (p.kind == "unknown" and is_english)]
        self.letters = _length(mine)
        if _length(mine) <= _length(theirs):  # a guest in an English prompt
            self.letters *= [p.kind for p in mine].count("looks") > lexicon.spaces
            self.pieces = [
                replace(p, english=words, kind="phrase", shade="")
                if p.kind in TABLES and p not in mine
                else p
                for p, words in zip(self.pieces, said, strict=True)
            ]


def _length(found: list[Piece]) -> int:
    return sum(piece.end - piece.start for piece in found)


def scene_parts(scene: SceneDescription) -> frozenset[str]:
    """What the names in a scene are made of, folded."""
    names: Iterable[str] = (*scene.objects, *scene.materials, *scene.lights, *scene.groups)
    return frozenset(folded(part) for name in names for part in (*parts(name), name))


def _phrases(vocabulary: Vocabulary) -> frozenset[str]:
    """Those of several words, and all that are not shipped."""
    words, shipped = frozenset([*vocabulary.synonyms, *vocabulary.colors]), shipped_vocabulary()
    own = words - shipped.synonyms.keys() - shipped.colors.keys()
    return own | {word for word in words if " " in word}


def _is_english(text: str, vocabulary: Vocabulary) -> bool:
    """Whether English has all of the words."""
    known = vocabulary.made(_known)
    return all(word in known or table().is_english(word) for word in text.lower().split())


def _known(v: Vocabulary) -> frozenset[str]:
    return frozenset().union(v.synonyms, v.colors, v.nouns, v.adjectives, v.intensity, *v.lists.values())


def _as_english(piece: Piece, vocabulary: Vocabulary) -> Piece:
    """A word that the language lacks and English has: an artist mixes them."""
    known = piece.kind == "unknown" and _is_english(piece.english, vocabulary)
    return replace(piece, kind="phrase") if known else piece
