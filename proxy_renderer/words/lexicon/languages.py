# SPDX-License-Identifier: Apache-2.0
"""Spelling, names of things in all languages (things.toml), and the lexicons of languages; the head of german.toml explains the format."""

from __future__ import annotations

import re
import tomllib
import unicodedata
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from itertools import product
from pathlib import Path
from typing import Any

from ...schema import VibeError
from .entries import at_line, normalize
from .vocabulary import shipped_vocabulary
from .word_table import table

_LETTERS = str.maketrans({"ß": "ss", "ł": "l", "ø": "o", "đ": "d", "æ": "ae", "œ": "oe"})
"""Letters that are no others with an accent -> how they are written without them."""
_EAST_ASIAN = ("\u2e80", "\uf900")
"""The first character of those scripts, and the one after their last."""
_SIBILANTS = ("sses", "nses", "xes", "ches", "shes")
TABLES = ("grammar", "behind", "looks", "things", "shades")
"""Tables of words; of a wording in several, the first counts, but shades count beside colors and materials."""
_SETTINGS = {
    "name": str,
    "spaces": bool,
    "endings": str,
    "links": str,
    "particles": str,
    "looks_follow": bool,
}
_PAIRS = {"endings": "the ending typed / that of the word", "particles": "the word / the look that it says"}
"""Settings that are lists of pairs -> how a pair is written."""
_SHORTEST = 4  # characters of a word that may be a part of a compound ("Obermaterial")
_TYPED = 20_000  # words of prompts whose bases are cached
_THINGS = 16_384  # words whose senses are cached
Wording = tuple[str, ...]


def folded(word: str) -> str:
    """A word in lower case and without accents."""
    if word.isascii():
        return word.lower()
    if _EAST_ASIAN[0] <= min(word) and max(word) < _EAST_ASIAN[1]:  # no case, no accents
        return unicodedata.normalize("NFC", word)
    letters = unicodedata.normalize("NFKD", word.lower().translate(_LETTERS))
    return unicodedata.normalize("NFC", "".join(c for c in letters if not 0x300 <= ord(c) < 0x370))


def as_spelled(word: str) -> str:
    """A word in lower case with its accents, each letter one character."""
    return unicodedata.normalize("NFC", word.lower()).replace("’", "'")


@cache
def _plurals() -> dict[str, str]:
    """Plurals that no ending tells -> the word for one."""
    rows = tomllib.loads(Path(__file__).with_name("names.toml").read_text("utf-8"))
    return dict(pair.split("/") for pair in rows["plurals"].split())


def singular(word: str) -> str:
    """A word without the ending of an English plural."""
    if word in _plurals():
        return _plurals()[word]
    if word.endswith("ies") and len(word) > 4:
        return word[:-3] + "y"
    if word.endswith(_SIBILANTS):
        return word[:-2]
    return word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 3 else word


def any_of(phrases: Iterable[str]) -> str:
    """A pattern of any of the phrases, the longest that fits."""
    return "(?:" + "|".join(map(re.escape, sorted(phrases, key=len, reverse=True))) + ")"


@dataclass(frozen=True)
class Meaning:
    """The meaning of a wording of another language."""

    english: str  # in English; "" for what English leaves out
    table: str  # one of `TABLES`
    shade: str = ""  # the same beside a color or a material; "" if it does not differ
    # other things that are called so: "esfera" is a sphere, and the dial of a watch
    others: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Wordings:
    """Wordings as they are spelled in one way: with their accents, or folded."""

    meanings: dict[Wording, Meaning]  # Wording, word by word -> its meaning
    endings: tuple[tuple[str, str], ...]  # pairs of an ending that is typed, and that of the word

    @cached_property
    def words(self) -> frozenset[str]:
        """All of their words."""
        return frozenset(word for wording in self.meanings for word in wording)

    @cached_property
    def forms(self) -> frozenset[str]:
        """All words as they may be inflected; many, for languages with spaces."""
        ends = ((w.removesuffix(b), t) for w in self.words for t, b in self.endings if w.endswith(b))
        return self.words | {stem + typed for stem, typed in ends if stem}

    def find(self, words: Sequence[str]) -> Wording | None:
        """The wording that words, spelled in the same way, are a form of; None where they are none."""
        each = [_bases(self, word) for word in words]
        return next((wording for wording in product(*each) if wording in self.meanings), None)


@lru_cache(_TYPED)
def _bases(wordings: Wordings, word: str) -> tuple[str, ...]:
    """The words that one may be a form of, itself first."""
    ends = ((t, b) for t, b in wordings.endings if word.endswith(t) and len(word) > len(t))
    every = (word, *(word.removesuffix(typed) + base for typed, base in ends))
    return tuple(dict.fromkeys(known for known in every if known in wordings.words))


@dataclass(frozen=True, eq=False)
class LanguageLexicon:
    """The words of a language."""

    name: str  # in English
    spaces: bool  # whether words are written apart
    looks_follow: bool  # whether look words stand after their noun
    links: tuple[str, ...]  # letters between the parts of a compound
    particles: dict[str, str]  # small word -> the look that it says at the end of a clause: "Lampe aus"
    spelled: Wordings  # the wordings as they are written
    folded: Wordings  # the same in lower case and without accents, as many type them
    looks: dict[str, tuple[str, ...]]  # english look word -> its wordings in the language
    things: dict[str, tuple[str, ...]]  # english name of a thing -> its names in the language

    def find(self, words: Sequence[str]) -> tuple[Wording, Meaning] | None:
        """The wording that words are a form of, folded, and its meaning; None where they are none.

        Accents count first: "glacé" is no "glace".
        """
        lower = [as_spelled(word) for word in words]
        wording = self.spelled.find(lower)
        if wording is not None:
            return tuple(map(folded, wording)), self.spelled.meanings[wording]
        wording = self.folded.find([folded(word) for word in lower])
        return None if wording is None else (wording, self.folded.meanings[wording])


@cache
def lexicons() -> tuple[LanguageLexicon, ...]:
    """Those that are shipped."""
    return tuple(map(load, sorted(Path(__file__).parents[1].joinpath("languages").glob("*.toml"))))


def load(path: Path) -> LanguageLexicon:
    """The lexicon of a file.

    Raises:
        VibeError: Something in it is not what it should be; names file, line and remedy.
    """
    text = path.read_text("utf-8")
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"{path}: {error}.", "Mend that line.") from error
    for what, quoted, remedy in _mistakes(content):
        raise at_line(path, text, what, remedy, quoted)
    settings = content["language"]
    rows = {name: {e: _listed(row) for e, row in content.get(name, {}).items()} for name in TABLES}
    endings, particles = (
        [
            (typed, meant)
            for typed, _, meant in (pair.partition("/") for pair in _listed(settings.get(key, "")))
        ]
        for key in _PAIRS
    )
    plain = Wordings(_meanings(rows, folded), tuple(endings))
    return LanguageLexicon(
        name=settings["name"],
        spaces=settings["spaces"],
        looks_follow=settings.get("looks_follow", False),
        links=_listed(settings.get("links", "")),
        particles=dict(particles),
        spelled=Wordings(_meanings(rows, as_spelled), tuple(endings)) if settings["spaces"] else plain,
        folded=plain,
        looks=rows["looks"],
        things=rows["things"],
    )


def _meanings(
    rows: dict[str, dict[str, tuple[str, ...]]], spelling: Callable[[str], str]
) -> dict[Wording, Meaning]:
    """The meanings of the wordings of all tables, spelled in one way."""
    meanings: dict[Wording, Meaning] = {}
    for meaning in (Meaning(english, name) for name in TABLES for english in rows[name]):
        kind, english = meaning.table, meaning.english
        for wording in rows[kind][english]:
            words = tuple(spelling(wording).replace("'", "' ").replace("-", " ").split())
            known = meanings.setdefault(words, meaning)
            if kind == "shades":
                meanings[words] = replace(known, shade=known.shade or english)
            elif known.table == kind == "things" and english != known.english:
                meanings[words] = replace(known, others=(*known.others, english))
    return meanings


def _listed(row: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in row.split(",") if part.strip())


def _mistakes(content: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Problems of a file, each with a text of its line, and the remedy."""
    tables = dict(content)
    settings = tables.pop("language", {})
    if not {"name", "spaces"} <= settings.keys():
        yield "[language] has no name or no spaces", "[language]", 'Write name = "German" and spaces = true.'
    for key, value in settings.items():
        if not isinstance(value, _SETTINGS.get(key, ())):
            yield f"'{key}' is not known, or of the wrong type", key, f"Use: {', '.join(_SETTINGS)}."
    for key, form in _PAIRS.items():
        wrong = next((pair for pair in _listed(str(settings.get(key, ""))) if pair.count("/") != 1), None)
        if wrong is not None:
            yield f"'{wrong}' of the {key} has no '/'", key, f"Write {form}."
    for name in tables.keys() - TABLES:
        yield f"'{name}' is no table", f"[{name}]", f"Use: [language], [{'], ['.join(TABLES)}]."
    for name, rows in tables.items():
        known: dict[str, str] = {}
        for english, row in rows.items():
            if not isinstance(row, str):
                yield f"'{english}' is no text", english, 'Write words in quotes: "matt, stumpf".'
                continue
            for wording in _listed(row):
                first = known.setdefault(wording, english)
                if first != english and name != "things":
                    problem = f"'{wording}' is in two rows, '{first}' and '{english}'"
                    yield problem, row, "Delete one of the two."


@dataclass(frozen=True)
class ThingWords:
    """Names of the same thing."""

    rows: dict[str, frozenset[str]]  # word -> the rows that it is in, each named by its first word
    joined: tuple[str, ...]  # of those, the words that a name without spaces may contain, the longest first

    def senses(self, word: str) -> frozenset[str]:
        """Rows that a word, or a few, of a prompt or of a name in a scene may mean, and the word itself."""
        plain = singular(folded(word))
        found = self.rows.get(plain, frozenset())
        if not found and not word.isascii():
            parts = [part for part in self.joined if part in plain and not part.isascii()]
            found = frozenset().union(*(self.rows[part] for part in parts))
        if not found and not table().is_english(plain.rpartition(" ")[2]):  # "black" does not end in "Lack"
            ends = (plain[start:] for start in range(len(plain) - _SHORTEST + 1))
            found = next((self.rows[end] for end in ends if end in self.rows), found)
        return found | {plain}


@lru_cache(_THINGS)
def senses(word: str) -> frozenset[str]:
    """`ThingWords.senses` of the words that are shipped."""
    return thing_words().senses(word)


@cache
def english_things() -> frozenset[str]:
    """Names of things in English that are no places, by the words that are shipped."""
    is_english = table().is_english
    every = ((name, *others.split(", ")) for name, others in _thing_tables()["things"].items())
    return frozenset(
        normalize(word)
        for name, *others in every
        for word in (name, *(each for each in others if all(map(is_english, each.split()))))
    )


@cache
def _thing_tables() -> dict[str, dict[str, str]]:
    text = Path(__file__).with_name("things.toml").read_text("utf-8")
    tables: dict[str, dict[str, str]] = tomllib.loads(text)
    return tables


@cache
def thing_words() -> ThingWords:
    """The words that are shipped: of things.toml, and of the lexicons that are names of things."""
    named = _thing_tables()["things"] | _thing_tables()["more"]
    rows: dict[str, set[str]] = defaultdict(set)
    for name, others in named.items():
        for word in (name, *others.split(",")):
            rows[singular(folded(normalize(word)))].add(name)
    kinds = shipped_vocabulary().nouns  # "light" is any light, not the one that is called so
    for lexicon in lexicons():
        matter = [(name, words) for name, words in lexicon.looks.items() if name in named]  # "Leder"
        things = [
            (name, words) for name, words in lexicon.things.items() if name in named or name not in kinds
        ]
        for name, words in (*matter, *things):
            for word in (name, *words):
                rows[singular(folded(normalize(word)))].add(name)
    frozen = {word: frozenset(names) for word, names in rows.items()}
    return ThingWords(frozen, tuple(sorted(frozen, key=len, reverse=True)))
