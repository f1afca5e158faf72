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
from ..types import SceneWords
from .order import ordered
from .pieces import Piece, pieces

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


def gloss(text: str, scene: SceneWords, vocabulary: Vocabulary) -> Gloss:
    """A prompt as English would say it; itself where it is English, or in no language that has a lexicon.

    Args:
        text: The prompt.
        scene: The names in the scene, which may be in any language.
        vocabulary: What English words mean.
    """
    names = scene_parts(scene)
    words = _WORD.findall(text.lower())
    if all(folded(word) in names or _is_english(word, vocabulary) for word in words):
        return Gloss(text, text)
    phrases = vocabulary.made(_phrases)
    best, most = None, 0
    for lexicon in lexicons():
        found = pieces(text, lexicon, names, phrases)
        foreign, english = _letters(found, text, vocabulary)
        guest = foreign <= english
        if foreign > most and (not guest or _has_looks(found, text, lexicon, vocabulary)):
            best, most = (lexicon, [_own(p, text, vocabulary) for p in found] if guest else found), foreign
    if best is None:
        return Gloss(text, text)
    lexicon, found = best
    said = [_as_english(piece, vocabulary) for piece in ordered(found, lexicon, vocabulary)]
    english_text = " ".join(piece.english for piece in said if piece.english)
    return Gloss(text, _TIGHT.sub(r"\1", english_text), lexicon.name, tuple(said))


def scene_parts(scene: SceneWords) -> frozenset[str]:
    """What the names in a scene are made of, folded."""
    names: Iterable[str] = (*scene.objects, *scene.materials, *scene.lights, *scene.groups)
    return frozenset(folded(part) for name in names for part in (*parts(name), name))


def _phrases(vocabulary: Vocabulary) -> frozenset[str]:
    """Those of several words, and all that are not shipped."""
    words, shipped = frozenset([*vocabulary.synonyms, *vocabulary.colors]), shipped_vocabulary()
    own = words - shipped.synonyms.keys() - shipped.colors.keys()
    return own | {word for word in words if " " in word}


def _letters(found: list[Piece], text: str, vocabulary: Vocabulary) -> tuple[int, int]:
    """Letters of the words that only the language knows, and of those that only English knows."""
    foreign = english = 0
    for piece in found:
        said = text[piece.start : piece.end]
        is_english = _is_english(said, vocabulary)
        if piece.kind == "phrase" or (piece.kind == "unknown" and is_english):
            english += len(said)
        elif piece.kind in TABLES and not is_english:
            foreign += len(said)
    return foreign, english


def _has_looks(found: list[Piece], text: str, lexicon: LanguageLexicon, vocabulary: Vocabulary) -> bool:
    """Whether an English prompt has look words of a language in it, and not just something that looks like one."""
    looks = [p for p in found if p.kind == "looks" and not _is_english(text[p.start : p.end], vocabulary)]
    return len(looks) > lexicon.spaces


def _own(piece: Piece, text: str, vocabulary: Vocabulary) -> Piece:
    """What English knows, as it is in an English prompt."""
    said = text[piece.start : piece.end]
    is_english = piece.kind in TABLES and _is_english(said, vocabulary)
    return replace(piece, english=said, kind="phrase", shade="") if is_english else piece


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
