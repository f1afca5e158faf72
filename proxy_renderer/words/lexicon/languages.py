# SPDX-License-Identifier: Apache-2.0
"""Loads and checks the lexicon of a language; the head of german.toml explains the format."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property, lru_cache
from itertools import groupby, product
from pathlib import Path
from typing import Any

from ...schema import VibeError
from .mistakes import at_line
from .spelling import as_spelled, folded

TABLES = ("grammar", "behind", "looks", "things", "shades")
"""Tables of words; of a wording in several, the first counts, but shades count beside colors and materials."""
_SETTINGS = {
    "name": str,
    "spaces": bool,
    "adjectives": str,
    "endings": str,
    "links": str,
    "compares": bool,
    "compounds": bool,
    "particles": str,
}
_SIDES = ("before", "after")
_WORDS = 20_000  # of prompts whose bases are kept
Wording = tuple[str, ...]


@dataclass(frozen=True)
class Meaning:
    """What a wording of another language says.

    Attributes:
        english: In English; "" for what English leaves out.
        table: One of `TABLES`.
        shade: What it is beside a color or a material; "" for the same.
        others: Other things that are called so: "esfera" is a sphere, and the dial of a watch.
    """

    english: str
    table: str
    shade: str = ""
    others: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Wordings:
    """Wordings as they are spelled in one way: with their accents, or folded.

    Attributes:
        meanings: Wording, word by word -> what it says.
        endings: What inflection makes of a word: the ending that is typed, and that of the word.
    """

    meanings: dict[Wording, Meaning]
    endings: tuple[tuple[str, str], ...]

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
        """The wording that words are a form of; None where they are none.

        Args:
            words: As they are typed, spelled in the same way.
        """
        each = [_bases(self, word) for word in words]
        return next((wording for wording in product(*each) if wording in self.meanings), None)

    def begins(self, letter: str) -> tuple[str, ...]:
        """The words that begin with a letter."""
        return self._by_letter.get(letter, ())

    @cached_property
    def _by_letter(self) -> dict[str, tuple[str, ...]]:
        words = sorted(self.words)
        return {letter: tuple(group) for letter, group in groupby(words, key=lambda word: word[:1])}


@lru_cache(_WORDS)
def _bases(wordings: Wordings, word: str) -> tuple[str, ...]:
    """The words that one may be a form of, itself first."""
    ends = ((t, b) for t, b in wordings.endings if word.endswith(t) and len(word) > len(t))
    every = (word, *(word.removesuffix(typed) + base for typed, base in ends))
    return tuple(dict.fromkeys(known for known in every if known in wordings.words))


@dataclass(frozen=True, eq=False)
class LanguageLexicon:
    """The words of a language.

    Attributes:
        name: In English.
        spaces: Whether words are written apart.
        adjectives: Whether they stand "before" or "after" their noun.
        compares: Whether "than" alone says that what follows is more so: 比地板暗.
        compounds: Whether words of several letters are made of such of one letter (for languages without spaces).
        links: What stands between the parts of a compound.
        particles: Small word -> the look that it says at the end of a clause: "Lampe aus".
        spelled: The wordings as they are written.
        folded: The same in lower case and without accents, as many type them.
        looks: English look word -> its wordings in the language.
        things: English name of a thing -> its names in the language.
    """

    name: str
    spaces: bool
    adjectives: str
    compares: bool
    compounds: bool
    links: tuple[str, ...]
    particles: dict[str, str]
    spelled: Wordings
    folded: Wordings
    looks: dict[str, tuple[str, ...]]
    things: dict[str, tuple[str, ...]]

    def find(self, words: Sequence[str]) -> tuple[Wording, Meaning] | None:
        """The wording that words are a form of, folded, and what it says; None where they are none.

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
    _check(path, text, content)
    settings = content["language"]
    rows = {table: {e: _listed(row) for e, row in content.get(table, {}).items()} for table in TABLES}
    split = (ending.split("/") for ending in _listed(settings.get("endings", "")))
    endings = tuple((typed, base) for typed, base in split)
    plain = Wordings(_meanings(rows, folded), endings)
    return LanguageLexicon(
        name=settings["name"],
        spaces=settings["spaces"],
        adjectives=settings.get("adjectives", "before"),
        compares=settings.get("compares", False),
        compounds=settings.get("compounds", False),
        links=_listed(settings.get("links", "")),
        particles=dict(particle.split("/") for particle in _listed(settings.get("particles", ""))),
        spelled=Wordings(_meanings(rows, as_spelled), endings) if settings["spaces"] else plain,
        folded=plain,
        looks=rows["looks"],
        things=rows["things"],
    )


def _meanings(
    rows: dict[str, dict[str, tuple[str, ...]]], spelling: Callable[[str], str]
) -> dict[Wording, Meaning]:
    """What the wordings of all tables say, spelled in one way."""
    meanings: dict[Wording, Meaning] = {}
    for meaning in (Meaning(english, table) for table in TABLES for english in rows[table]):
        table, english = meaning.table, meaning.english
        for wording in rows[table][english]:
            words = tuple(spelling(wording).replace("'", "' ").replace("-", " ").split())
            known = meanings.setdefault(words, meaning)
            if table == "shades":
                meanings[words] = replace(known, shade=known.shade or english)
            elif known.table == table == "things" and english != known.english:
                meanings[words] = replace(known, others=(*known.others, english))
    return meanings


def _listed(row: str) -> tuple[str, ...]:
    return tuple(part.strip() for part in row.split(",") if part.strip())


def _check(path: Path, text: str, content: dict[str, Any]) -> None:
    """Raises VibeError at the first mistake."""
    for what, quoted, remedy in _mistakes(content):
        raise at_line(path, text, what, remedy, quoted)


def _mistakes(content: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """What is wrong, a text of its line, and the remedy."""
    tables = dict(content)
    settings = tables.pop("language", {})
    if not {"name", "spaces"} <= settings.keys():
        yield "[language] has no name or no spaces", "[language]", 'Write name = "German" and spaces = true.'
    for key, value in settings.items():
        if not isinstance(value, _SETTINGS.get(key, ())):
            yield f"'{key}' is not known, or of the wrong type", key, f"Use: {', '.join(_SETTINGS)}."
    if settings.get("adjectives", "before") not in _SIDES:
        yield "adjectives stand before or after nouns", "adjectives", 'Write adjectives = "after".'
    for ending in _listed(str(settings.get("endings", ""))):
        if ending.count("/") != 1:
            yield f"the ending '{ending}' has no '/'", "endings", "Write the ending typed / that of the word."
    for particle in _listed(str(settings.get("particles", ""))):
        if particle.count("/") != 1:
            yield (
                f"the particle '{particle}' has no '/'",
                "particles",
                "Write the word / the look that it says.",
            )
    for table in tables.keys() - TABLES:
        yield f"'{table}' is no table", f"[{table}]", f"Use: [language], [{'], ['.join(TABLES)}]."
    for table, rows in tables.items():
        yield from _mistaken_rows(rows, may_repeat=table == "things")


def _mistaken_rows(rows: dict[str, Any], may_repeat: bool) -> Iterator[tuple[str, str, str]]:
    """Mistakes in one table: what is no text, and a wording that is there twice where it may not be."""
    known: dict[str, str] = {}
    for english, row in rows.items():
        if not isinstance(row, str):
            yield f"'{english}' is no text", english, 'Write words in quotes: "matt, stumpf".'
            continue
        for wording in _listed(row):
            first = known.setdefault(wording, english)
            if first != english and not may_repeat:
                yield f"'{wording}' is in two rows, '{first}' and '{english}'", row, "Delete one of the two."
