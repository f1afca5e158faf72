# SPDX-License-Identifier: Apache-2.0
"""Prompts in other languages: English wordings of a lexicon in place of the artist's, and back again for the report."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Container, Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import Literal

from .lexicon.entries import normalize
from .lexicon.languages import TABLES, LanguageLexicon, Meaning, folded, lexicons
from .lexicon.vocabulary import Vocabulary, shipped_vocabulary
from .lexicon.word_table import table
from .names import parts
from .types import Attribute, Parsed, SceneDescription

_LONGEST = 5  # words of a wording
_SHORTEST = 3  # characters of a part of a compound
_LONGEST_TIGHT = 14  # characters of a word that is written without spaces
_WORD, _LETTER, _UNKNOWN = 1.0, 1.2, 2.0
"""Cost of a known word without spaces around it, of one of a single character, and of each unknown character."""
_SCENES = 8  # whose names are cached with the words of a language
_NEAR = 6  # words that may stand between a look word and its intensity
_WORDS = re.compile(r"[^\W_]+")
_PARTS = re.compile(r"#[0-9a-fA-F]{6}\b|[^\W_]+['’]?|(?<!\w)[-_]|[-_](?!\w)|[^\w\s-]")
_SPACELESS = re.compile(r"[\u2e80-\u9fff\uf900-\ufaff]")
_LATIN = re.compile(r"[a-zA-Z0-9]")
_MARKS = {"、": ",", "。": ".", "・": " ", "「": '"', "」": '"'}
_TIGHT = re.compile(r"\s+([,.;:!?])")
_QUOTED = re.compile(r"(?<=')[^']+(?=')")
_LOOKS = ("looks", "shades", "phrase")
"""Kinds of pieces that are look words."""
_NOUNS = ("things", "name", "unknown")
"""Kinds of pieces that look words stand beside."""
_FOLLOWING = re.compile("(N*)(I*L(?:A?I*L)*)")
_GENITIVE = "'s"
"""English of what ties a thing to what it belongs to, or a look to its thing; "blue's car" is a blue car."""


@dataclass(frozen=True)
class Piece:
    """A part of a prompt.

    Attributes:
        english: Its meaning; as it stands in the prompt where nobody knows it.
        start, end: Places of its first character and after its last one.
        kind: A table of the lexicon, "name" of a thing in the scene, "phrase" of the vocabulary, "mark" for punctuation, or
            "unknown".
        shade: Its meaning beside a color or a material; "" for the same.
    """

    english: str
    start: int
    end: int
    kind: str
    shade: str = ""


@dataclass(frozen=True)
class Gloss:
    """A prompt in English words."""

    prompt: str  # as the artist wrote it
    english: str  # as it is read
    language: str = ""  # that it is in; "" for English
    pieces: tuple[Piece, ...] = ()  # the parts of the prompt that the English words stand for

    @property
    def unknown(self) -> list[str]:
        """Words that neither the language's lexicon nor English knows, nor the scene has, as the prompt says them."""
        unknown = (p.english for p in self.pieces if p.kind == "unknown")
        return [word for word in unknown if word.isalpha() and len(word) > 1]


def gloss(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> Gloss:
    """A prompt in English words; itself where it is English, or in no language that has a lexicon."""
    names = _scene_parts(scene)
    words = _WORDS.findall(text.lower())
    if all(folded(word) in names or _is_english(word, vocabulary) for word in words):
        return Gloss(text, text)
    tried = ((*_attempt(text, lexicon, names, vocabulary), lexicon) for lexicon in lexicons())
    letters, found, lexicon = max(tried, key=lambda attempt: attempt[0])
    if not letters:
        return Gloss(text, text)
    said = []
    for piece, after in zip(found, (*found[1:], None), strict=True):
        # "Lampe aus" is off, "aus Messing" made of brass
        look = lexicon.particles.get(folded(text[piece.start : piece.end]), "")
        if look and (after is None or after.kind == "mark"):
            piece = replace(piece, english=look, kind="looks")
        if piece.english and piece.english != _GENITIVE:
            mixed = piece.kind == "unknown" and _is_english(piece.english, vocabulary)
            said.append(replace(piece, kind="phrase") if mixed else piece)
    said = _in_english_order(said, lexicon.looks_follow, vocabulary)
    for place, (piece, after) in enumerate(pairwise(said)):  # "bright" wood is light wood
        if piece.shade and (
            after.english in vocabulary.colors or vocabulary.slot(after.english) == "material"
        ):
            said[place] = replace(piece, english=piece.shade)
    english_text = " ".join(piece.english for piece in said)
    return Gloss(text, _TIGHT.sub(r"\1", english_text), lexicon.name, tuple(said))


def _in_english_order(found: list[Piece], looks_follow: bool, vocabulary: Vocabulary) -> list[Piece]:
    """Pieces with prepositions before their words, "sink except" as "except sink", and looks before nouns, "car blue dark".

    Args:
        looks_follow: Whether looks stand after their nouns in the language.
    """
    placed: list[Piece] = []
    for piece in found:
        if piece.kind != "behind":
            placed.append(piece)
            continue
        start = max(len(placed) - 1, 0)
        while start > 0 and placed[start - 1].kind in _LOOKS and placed[-1].kind in (*_LOOKS, *_NOUNS):
            start -= 1
        first, *last = (
            replace(piece, english=part.strip(), kind="grammar") for part in piece.english.split("~")
        )
        placed = [*placed[:start], first, *placed[start:], *last]
    if not looks_follow:
        return placed
    # One letter for each piece: look, noun (a night is one), intensity, and, other
    row = ""
    for piece in placed:
        noun = piece.english in vocabulary.nouns or vocabulary.slot(piece.english) == "setting"
        is_noun = piece.kind in _NOUNS or (piece.kind == "looks" and noun)
        small = "A" if piece.english == "and" else "I" if piece.english in vocabulary.intensity else "O"
        row += "N" if is_noun else "L" if piece.kind in _LOOKS else small
    for match in _FOLLOWING.finditer(row):
        nouns, looks = (placed[slice(*match.span(group))] for group in (1, 2))
        units: list[list[Piece]] = [[]]
        for piece in looks:  # a unit ends in its look
            units[-1].append(piece)
            units += [[]] if piece.kind in _LOOKS else []
        turned = [p for unit in reversed(units) for p in sorted(unit, key=lambda p: p.english == "and")]
        if nouns or row[match.end() : match.end() + 1] != "N":  # looks before a noun stay there
            placed[slice(*match.span())] = [*turned, *nouns]
    return placed


def _attempt(
    text: str, lexicon: LanguageLexicon, names: frozenset[str], vocabulary: Vocabulary
) -> tuple[int, list[Piece]]:
    """A prompt as if it were in one language: characters of the words that only the language knows, and the pieces.

    The first is 0 for an English prompt in which nothing else is a look of the language.
    """
    found = pieces(text, lexicon, names, vocabulary.made(_phrases))
    is_english = [_is_english(text[p.start : p.end], vocabulary) for p in found]
    both = [*zip(found, is_english, strict=True)]
    mine = [p for p, english in both if p.kind in TABLES and not english]
    theirs = [p for p, english in both if p.kind == "phrase" or (p.kind == "unknown" and english)]
    letters, others = (sum(p.end - p.start for p in some) for some in (mine, theirs))
    if letters <= others:  # a guest in an English prompt
        letters *= [p.kind for p in mine].count("looks") > lexicon.spaces
        for place, (piece, english) in enumerate(both):
            if piece.kind in TABLES and english:
                found[place] = Piece(text[piece.start : piece.end], piece.start, piece.end, "phrase")
    return letters, found


def _scene_parts(scene: SceneDescription) -> frozenset[str]:
    """Parts of the names in a scene, folded."""
    names: Iterable[str] = (*scene.objects, *scene.materials, *scene.lights, *scene.groups)
    return frozenset(folded(part) for name in names for part in (*parts(name), name))


def _phrases(vocabulary: Vocabulary) -> frozenset[str]:
    """Phrases of several words, and all words that are not shipped."""
    words, shipped = frozenset([*vocabulary.synonyms, *vocabulary.colors]), shipped_vocabulary()
    own = words - shipped.synonyms.keys() - shipped.colors.keys()
    return own | {word for word in words if " " in word}


def _is_english(text: str, vocabulary: Vocabulary) -> bool:
    known = vocabulary.made(_known_english)
    return all(word in known or table().is_english(word) for word in text.lower().split())


def _known_english(v: Vocabulary) -> frozenset[str]:
    return frozenset().union(v.synonyms, v.colors, v.nouns, v.adjectives, v.intensity, *v.lists.values())


def pieces(
    text: str, lexicon: LanguageLexicon, names: frozenset[str], phrases: Container[str] = ()
) -> list[Piece]:
    """All pieces of a prompt, in its order.

    Args:
        names: Parts of the names in the scene, folded.
        phrases: Phrases that stay as they are: "film noir", and the artist's own words.
    """
    cuts, found = list(_cuts(text, lexicon, names)), list[Piece]()
    while cuts:
        counts = range(min(_LONGEST, len(cuts)), 0, -1)
        wholes = ((count, _whole(text, cuts[:count], lexicon, names, phrases)) for count in counts)
        count, whole = next((each for each in wholes if each[1]), (1, None))
        found += [whole] if whole else _single(cuts[0], lexicon, names)
        del cuts[:count]
    return found


def _cuts(text: str, lexicon: LanguageLexicon, names: frozenset[str]) -> Iterator[Piece]:
    """Words and marks; where words are not written apart, those that the lexicon or the scene knows."""
    tight = frozenset(filter(_SPACELESS.search, names))  # most scenes have none, and share a set
    for match in _PARTS.finditer(text):
        start, word = match.start(), match.group()
        apart = lexicon.spaces or not _SPACELESS.search(word)
        for part in [word] if apart else cut(word, _known_forms(lexicon, tight)):
            yield Piece(part, start, start + len(part), "unknown")
            start += len(part)


@lru_cache(_SCENES)
def _known_forms(lexicon: LanguageLexicon, names: frozenset[str]) -> frozenset[str]:
    return frozenset({*lexicon.folded.forms, *names} - {""})


def cut(letters: str, known: Container[str]) -> list[str]:
    """The words of characters without spaces: the path of least cost; unknown characters in a row are one word."""
    best: list[tuple[float, list[int]]] = [
        (0.0, [])
    ]  # of the characters up to each place: cost, negative lengths of words
    for end in range(1, len(letters) + 1):
        paths = [(best[end - 1][0] + _UNKNOWN, [*best[end - 1][1], -1])]
        for start in range(max(end - _LONGEST_TIGHT, 0), end):
            if letters[start:end] in known:
                cost, words = best[start]
                paths.append((cost + (_WORD if end - start > 1 else _LETTER), [*words, start - end]))
        best.append(min(paths))  # of two that cost the same, the one whose first words are longer
    found: list[str] = []
    place, joins = 0, False
    for length in best[-1][1]:
        word = letters[place : place - length]
        unknown = word not in known
        if unknown and joins and bool(_LATIN.match(found[-1][-1])) == bool(_LATIN.match(word)):
            found[-1] += word
        else:
            found.append(word)
        place, joins = place - length, unknown
    return found


def _whole(
    text: str, cuts: list[Piece], lexicon: LanguageLexicon, names: frozenset[str], phrases: Container[str]
) -> Piece | None:
    """Some words in a row as one piece; None where they are none."""
    start, end = cuts[0].start, cuts[-1].end
    own = Piece(text[start:end], start, end, "unknown")
    if " ".join(cut.english.lower() for cut in cuts) in phrases:
        return replace(own, kind="phrase")
    found = lexicon.find([cut.english for cut in cuts])
    if found is None:
        return None
    wording, meaning = found
    named = len(cuts) == 1 and not {folded(cuts[0].english), wording[0]}.isdisjoint(names)
    if named and meaning.table == "things":
        return replace(own, kind="name")
    here = (other for other in meaning.others if other in names)
    return replace(_meant(own, meaning), english=next(here, meaning.english))


def _single(cut: Piece, lexicon: LanguageLexicon, names: frozenset[str]) -> list[Piece]:
    """A word that is no wording: a mark, a name, the parts of a compound; itself where nobody knows it."""
    if not cut.english[0].isalnum():
        mark = _MARKS.get(cut.english) or unicodedata.normalize("NFKC", cut.english)
        return [replace(cut, english=mark, kind="mark")]
    word, known = folded(cut.english), lexicon.folded
    if word in names:
        return [replace(cut, kind="name")]
    for place in range(len(word) - _SHORTEST, _SHORTEST - 1, -1) if lexicon.links else ():
        last = known.find([word[place:]])
        heads = [word[:place], *(word[:place].removesuffix(link) for link in lexicon.links)]
        first = next(((h,) for h in heads if len(h) >= _SHORTEST and (h,) in known.meanings), None)
        if first and last:
            both = (known.meanings[first], known.meanings[last])
            return [_meant(cut, meaning) for meaning in both if meaning.table != "grammar"] or [cut]
    return [cut]


def _meant(cut: Piece, meaning: Meaning) -> Piece:
    return replace(cut, english=meaning.english, kind=meaning.table, shade=meaning.shade)


class Retelling:
    """Finds the artist's words for English ones of a gloss."""

    def __init__(self, gloss: Gloss) -> None:
        self.gloss = gloss
        self._words = [(word, p) for p in gloss.pieces for word in _WORDS.findall(normalize(p.english))]
        self._taken: set[int] = set()

    def retell(self, parsed: Parsed) -> None:
        """Puts the artist's words in place of the English ones, wherever people read them; changes `parsed`."""
        parsed.attributes = [self._attribute(attribute) for attribute in parsed.attributes]
        for thing in parsed.objects:
            thing.attributes = {
                slot: ", ".join(map(self.own, words.split(", "))) for slot, words in thing.attributes.items()
            }
        parsed.ignored = [self.own(text) for text in parsed.ignored]
        parsed.guesses = {self.own(word): entry for word, entry in parsed.guesses.items()}
        parsed.notes = [_QUOTED.sub(lambda m: self.own(m[0]), text) for text in parsed.notes]

    def own(self, english: str) -> str:
        """The artist's words for English ones; these themselves where they are not from the prompt."""
        found = self._find(english, again=True)
        return self._text(found) if found else english

    def english(self, word: str) -> str:
        """The English words for one of the prompt; "" where the prompt lacks it."""
        start = self.gloss.prompt.casefold().find(word.casefold())
        end = start + len(word)
        meant = (piece for piece in self.gloss.pieces if piece.start < end and start < piece.end)
        return " ".join(piece.english for piece in meant) if start >= 0 else ""

    def _attribute(self, attribute: Attribute) -> Attribute:
        if attribute.cause:
            return replace(attribute, cause=self.own(attribute.cause))
        found = self._find(attribute.word)
        if not found:
            return attribute
        look = self._words[found[-1]][1]
        start = next(p.start for p in self._pieces(found) if p.end <= look.start + 1 or p is look)
        return replace(attribute, word=self._text(found), english=attribute.word, place=(start, look.end))

    def _find(self, english: str, again: bool = False) -> list[int]:
        """Places of words: the last ones together, those before them near; none where the last is not there."""
        words = _WORDS.findall(normalize(english))
        said = [word for word, _ in self._words]
        for count in range(len(words), 0, -1):
            ends = (end for end in range(count, len(said) + 1) if said[end - count : end] == words[-count:])
            if end := next((end for end in ends if again or end not in self._taken), 0):
                self._taken.add(end)
                start = end - count
                near = range(max(start - _NEAR, 0), start)
                return [*(i for word in words[:-count] for i in near if said[i] == word), *range(start, end)]
        return []

    def _pieces(self, found: list[int]) -> list[Piece]:
        return sorted({self._words[i][1] for i in found}, key=lambda piece: (piece.start, piece.end))

    def _text(self, found: list[int]) -> str:
        """The prompt's words, in its order."""
        spans = sorted({(piece.start, piece.end) for piece in self._pieces(found)})
        text, last = "", spans[0][0]
        for start, end in spans:
            gap = self.gloss.prompt[last:start]
            text += (" " if gap.strip() else gap) + self.gloss.prompt[start:end]
            last = end
        return text


def understood() -> str:
    """Advice for a prompt in another language, in one line."""
    *first, last = ("English", *(lexicon.name for lexicon in lexicons()))
    names = f"{', '.join(first)} and {last}"
    return f"{names} are understood: write for example 'glossy teal, soft warm light, slight vignette'."


def other_language(text: str) -> Literal["", "some", "all"]:
    """How much of a prompt is in another script than the Latin one, or has small words of unread languages."""
    letters = [c for c in text if c.isalpha()]
    latin = sum("LATIN" in unicodedata.name(c, "") for c in letters)
    if letters and latin < 0.5 * len(letters):
        return "all"
    if latin < len(letters):
        return "some"
    words = text.lower().split()
    small = sum(word.strip(".,;:!?") in _small_words() for word in words)
    return "some" if small >= 2 or (small and small >= 0.15 * len(words)) else ""


@cache
def _small_words() -> frozenset[str]:
    """Small words of languages that have no lexicon."""
    lines = (Path(__file__).with_name("languages") / "unread.txt").read_text("utf-8").splitlines()
    return frozenset(word for line in lines if not line.startswith("#") for word in line.split())
