# SPDX-License-Identifier: Apache-2.0
"""Prompts in other languages: translates them to English by the wordings of a lexicon, and back for the report."""

import re
import unicodedata
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from .lexicon.entries import normalize
from .lexicon.languages import TABLES, LanguageLexicon, folded, lexicons, table
from .lexicon.vocabulary import Vocabulary, shipped_vocabulary
from .names import parts
from .types import Parsed, SceneDescription

_LONGEST = 5  # words of a wording
_LONGEST_TIGHT = 14  # characters of a word that is written without spaces
_NEAR = 6  # words that may stand between a look word and its intensity
_WORDS = re.compile(r"[^\W_]+")
_PARTS = re.compile(r"#[0-9a-fA-F]{6}\b|[^\W_]+['’]?|(?<!\w)[-_]|[-_](?!\w)|[^\w\s-]")
_SPACELESS = re.compile(r"[\u2e80-\u9fff\uf900-\ufaff]")
_MARKS = {"、": ",", "。": ".", "・": " ", "「": '"', "」": '"'}
_TIGHT = re.compile(r"\s+([,.;:!?])")
_LOOKS, _NOUNS = ("looks", "shades", "phrase"), ("things", "name", "unknown")
"""Kinds of pieces that are look words, and kinds that look words stand next to."""
_GENITIVE = "'s"  # English of a word that ties a thing to its owner; it is left out
_QUOTED = re.compile(r"(?<=')[^']+(?=')")


@dataclass(frozen=True)
class Piece:
    """A part of a prompt with its meaning in English."""

    english: str  # its meaning; the text of the prompt if it is unknown
    start: int  # place of its first character
    end: int  # place after its last character
    # a table of the lexicon, "name" of a thing in the scene, "phrase" in English, "mark" for punctuation, or "unknown"
    kind: str


@dataclass(frozen=True)
class Gloss:
    """A prompt, translated to English words."""

    prompt: str  # as the artist wrote it
    english: str  # as it is read
    language: str = ""  # of the prompt, in English: "German"; "" for English
    pieces: tuple[Piece, ...] = ()  # the parts of the prompt that the English words stand for

    @property
    def unknown(self) -> list[str]:
        """Words of the prompt that are neither in the language's lexicon, nor English, nor names in the scene."""
        unknown = (p.english for p in self.pieces if p.kind == "unknown")
        return [word for word in unknown if word.isalpha() and len(word) > 1]


def gloss(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> Gloss:
    """A prompt, translated to English word by word; unchanged if it is English, or in a language without a lexicon."""
    every = (*scene.objects, *scene.materials, *scene.lights, *scene.groups)
    names = frozenset(folded(part) for name in every for part in (*parts(name), name))
    words = _WORDS.findall(text.lower())
    if all(folded(word) in names or _is_english(word, vocabulary) for word in words):
        return Gloss(text, text)
    tried = ((*_attempt(text, lexicon, names, vocabulary), lexicon.name) for lexicon in lexicons())
    letters, found, language = max(tried, key=lambda attempt: attempt[0])
    if not letters:
        return Gloss(text, text)
    # In English, small words that follow a thing and its looks go before them: "fog without" → "without fog"
    led: list[Piece] = []
    for piece in found:
        start = len(led)
        if piece.kind == "behind" and led and led[-1].kind in (*_NOUNS, *_LOOKS):
            start -= 1
            while start and led[start - 1].kind in _LOOKS:
                start -= 1
        led.insert(start, piece)
    said = tuple(piece for piece in led if piece.english not in ("", _GENITIVE))
    return Gloss(text, _TIGHT.sub(r"\1", " ".join(piece.english for piece in said)), language, said)


def _attempt(
    text: str, lexicon: LanguageLexicon, names: frozenset[str], vocabulary: Vocabulary
) -> tuple[int, list[Piece]]:
    """A prompt, read in the language of `lexicon`: characters in words that are of this language only, and the pieces.

    The number is 0 for a mostly English prompt with too few look words of the language.
    """
    found = pieces(text, lexicon, names, vocabulary.made(_phrases))
    english = {p for p in found if p.kind != "phrase" and _is_english(text[p.start : p.end], vocabulary)}
    found = [replace(p, kind="phrase") if p in english and p.kind == "unknown" else p for p in found]
    mine = [p for p in found if p.kind in TABLES and p not in english]
    theirs = [p for p in found if p.kind == "phrase"]
    letters, others = (sum(p.end - p.start for p in some) for some in (mine, theirs))
    if letters > others:
        return letters, found
    # The prompt is mostly English
    letters *= [p.kind for p in mine].count("looks") > lexicon.spaces
    own = (replace(p, english=text[p.start : p.end], kind="phrase") if p in english else p for p in found)
    return letters, [*own]


def _phrases(vocabulary: Vocabulary) -> frozenset[str]:
    """English that is not translated: phrases of several words ("film noir"), and words of the artist's own entries."""
    words, shipped = {*vocabulary.synonyms, *vocabulary.colors}, shipped_vocabulary()
    return frozenset(w for w in words if " " in w or not (w in shipped.synonyms or w in shipped.colors))


def _is_english(text: str, vocabulary: Vocabulary) -> bool:
    known = vocabulary.made(_known_english)
    return all(
        word in known
        or table().is_english(word)
        or not vocabulary.adjectives.keys().isdisjoint(vocabulary.stems(word, "comparative"))
        for word in text.lower().split()
    )


def _known_english(v: Vocabulary) -> frozenset[str]:
    return frozenset().union(v.synonyms, v.colors, v.nouns, v.adjectives, v.intensity, *v.lists.values())


def pieces(
    text: str, lexicon: LanguageLexicon, names: frozenset[str], phrases: frozenset[str] = frozenset()
) -> list[Piece]:
    """All pieces of a prompt, in its order: the longest wordings, `names` of the scene (folded) or English `phrases`.

    Text without spaces is cut into words of the lexicon or the scene, see `cut`.
    """
    cuts, found = list[Piece](), list[Piece]()
    for match in _PARTS.finditer(text):
        start, word = match.start(), match[0]
        apart = lexicon.spaces or not _SPACELESS.search(word)
        for part in [word] if apart else cut(word, lexicon.forms | names):
            cuts.append(Piece(part, start, start + len(part), "unknown"))
            start += len(part)
    while cuts:
        counts = range(min(_LONGEST, len(cuts)), 0, -1)
        each = ((n, _piece(text, cuts[:n], lexicon, names, phrases)) for n in counts)
        count, piece = next((n, piece) for n, piece in each if piece)
        found.append(piece)
        del cuts[:count]
    return found


def cut(letters: str, known: frozenset[str]) -> list[str]:
    """The words in text without spaces, each the longest of `known`; unknown characters in a row are one word."""
    found, place, unknown = list[str](), 0, ""
    while place < len(letters):
        words = (letters[place : place + count] for count in range(_LONGEST_TIGHT, 0, -1))
        word = next((word for word in words if word in known), "")
        if word:
            found += [unknown, word]
        unknown = "" if word else unknown + letters[place]
        place += len(word) or 1
    return [word for word in (*found, unknown) if word]


def _piece(
    text: str, cuts: list[Piece], lexicon: LanguageLexicon, names: frozenset[str], phrases: frozenset[str]
) -> Piece | None:
    """Neighboring words, `cuts`, as one piece; None if they mean nothing together. A single word is always a piece."""
    start, end, single = cuts[0].start, cuts[-1].end, cuts[0] if len(cuts) == 1 else None
    own = Piece(text[start:end], start, end, "unknown")
    if " ".join(cut.english.lower() for cut in cuts) in phrases:
        return replace(own, kind="phrase")
    wording, (english, table) = lexicon.find([cut.english for cut in cuts]) or ((), ("", ""))
    if single and table in ("", "things") and not names.isdisjoint((folded(own.english), *wording)):
        return replace(own, kind="name")
    if table:
        return replace(own, english=english, kind=table)
    if single and not single.english[0].isalnum():
        mark = _MARKS.get(single.english) or unicodedata.normalize("NFKC", single.english)
        return replace(own, english=mark, kind="mark")
    return single


class Retelling:
    """Translates English words of a gloss back into the artist's words."""

    def __init__(self, gloss: Gloss) -> None:
        self.gloss = gloss
        self._words = [(word, p) for p in gloss.pieces for word in _WORDS.findall(normalize(p.english))]
        self._taken: set[int] = set()

    def retell(self, parsed: Parsed) -> None:
        """Puts the artist's words in place of the English ones in all fields of `parsed` that people read."""
        for number, attribute in enumerate(parsed.attributes):
            if attribute.cause:
                parsed.attributes[number] = replace(attribute, cause=self.own(attribute.cause))
            elif found := self._find(attribute.word):
                word, place = self._text(found), (found[-1].start, found[-1].end)
                parsed.attributes[number] = replace(attribute, word=word, english=attribute.word, place=place)
        for thing in parsed.objects:
            for slot, words in thing.attributes.items():
                thing.attributes[slot] = ", ".join(map(self.own, words.split(", ")))
        parsed.ignored = [self.own(text) for text in parsed.ignored]
        parsed.absent = tuple(map(self.own, parsed.absent))
        parsed.guesses = {self.own(word): entry for word, entry in parsed.guesses.items()}
        parsed.notes = [_QUOTED.sub(lambda m: self.own(m[0]), text) for text in parsed.notes]

    def own(self, english: str) -> str:
        """The artist's words for English ones; the English ones if they do not come from the prompt."""
        return self._text(self._find(english, again=True)) or english

    def english(self, word: str) -> str:
        """The English words for `word`, a word of the prompt; "" if the prompt lacks it."""
        start = self.gloss.prompt.casefold().find(word.casefold())
        end = start + len(word)
        meant = (piece for piece in self.gloss.pieces if piece.start < end and start < piece.end)
        return " ".join(piece.english for piece in meant) if start >= 0 else ""

    def _find(self, english: str, again: bool = False) -> list[Piece]:
        """The pieces that English words come from: of as many last words as stand together, and of others just before.

        [] if the last word is in no piece. Only with `again` may a place be found a second time.
        """
        words = _WORDS.findall(normalize(english))
        said = [word for word, _ in self._words]
        for count in range(len(words), 0, -1):
            ends = (end for end in range(count, len(said) + 1) if said[end - count : end] == words[-count:])
            if end := next((end for end in ends if again or end not in self._taken), 0):
                self._taken.add(end)
                start = end - count
                near = range(max(start - _NEAR, 0), start)
                places = [*(i for i in near if said[i] in words[:-count]), *range(start, end)]
                return [self._words[i][1] for i in places]
        return []

    def _text(self, found: list[Piece]) -> str:
        text, last = "", 0
        for start, end in sorted({(piece.start, piece.end) for piece in found}):
            gap = self.gloss.prompt[last:start] if text else ""
            text, last = text + (" " if gap.strip() else gap) + self.gloss.prompt[start:end], end
        return text


def understood() -> str:
    """A sentence with the languages that are understood and an example: a remedy for a prompt in another language."""
    *first, last = ("English", *(lexicon.name for lexicon in lexicons()))
    remedy = "write for example 'glossy teal, soft warm light, slight vignette'."
    return f"{', '.join(first)} and {last} are understood: {remedy}"


def other_language(text: str) -> Literal["", "some", "all"]:
    """The amount of a prompt in languages that are not read, judged by script and small words; "" for none."""
    letters = [c for c in text if c.isalpha()]
    latin = sum("LATIN" in unicodedata.name(c, "") for c in letters)
    if letters and latin < 0.5 * len(letters):
        return "all"
    if latin < len(letters):
        return "some"
    words = text.lower().split()
    unread = (Path(__file__).with_name("languages") / "unread.txt").read_text("utf-8").splitlines()
    small_words = {word for line in unread if not line.startswith("#") for word in line.split()}
    small = sum(word.strip(".,;:!?") in small_words for word in words)
    return "some" if small >= 2 or (small and small >= 0.15 * len(words)) else ""
