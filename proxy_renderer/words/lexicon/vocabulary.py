# SPDX-License-Identifier: Apache-2.0
"""The vocabulary (vocabulary.toml, colors.txt): all that parser and planner know of words, and the artist's own words.

The artist's own words are a .toml file that adds entries and colors to the vocabulary, or replaces them:

    [look."brand red"]            # the same rows as in vocabulary.toml, whose head explains them
    slot = "material"
    words = "our red, house red"
    wishes = ["material/base_color color #c8102e !1", "material/roughness 0.1..0.2 !2"]

    [colors]
    "midnight plum" = "#3a1238"

The file is the one that $VIBE_VOCABULARY names (`vibe --vocabulary FILE` sets it), else `vocabulary.toml` in the user's
configuration folder.
"""

from __future__ import annotations

import json
import os
import re
import tomllib
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache
from pathlib import Path
from typing import Any, TypeVar

from ...color.floats import is_hex, srgb_from_hex
from ...folders import config_folder
from ...schema import Values, VibeError, atomic
from .entries import Effect, VocabularyEntry, at_line, listed, normalize, parse_effect, read_entry
from .rigs import rig_table

VARIABLE = "VIBE_VOCABULARY"
GLOWING = "glowing"  # the entry of what emits light
_SHORTEST_STEM = 2  # characters; a stem has more
_VERSIONS = 2  # of the artist's file that are remembered
_LARGEST = 2_000_000  # bytes; a vocabulary is text that somebody wrote
_QUOTED = re.compile("'([^']+)'")
_COLORS = re.compile(r"^\[colors\][^\n]*\n", re.MULTILINE)
# Color temperatures
_LEAST, _MOST, _STEP = 1300, 15500, 100  # kelvins of the entries
_REACH = 0.03  # share by which a light's kelvins may differ from those of the prompt
_WARM = 4800  # kelvins below which light is warm
_COOL = 7200  # above which it is cool
T = TypeVar("T")


@dataclass(frozen=True)
class Vocabulary:
    """All that parser and planner know of words."""

    entries: dict[str, VocabularyEntry]  # name -> entry
    synonyms: dict[str, str]  # phrase -> entry name
    colors: dict[str, Values]  # color name -> sRGB
    shades: dict[str, dict[str, float]]  # shade word -> keyword arguments: lightness, towards, chroma, warmth
    intensity: dict[str, float]  # phrase -> strength
    lists: dict[str, frozenset[str]]  # "negation", "link", "around", ... -> phrases
    nouns: dict[str, str]  # phrase -> kind of thing
    painted: dict[str, tuple[Effect, ...]]  # kind of thing -> effects of a color word on it
    adjectives: dict[str, dict[str, str]]  # word -> kind of thing (or "otherwise") -> entry name
    absent: dict[str, str]  # kind of thing -> entry that the lack of it means: "no shadows"
    words: dict[str, frozenset[str]]  # row of [grammar.words], as "lightness" or "off" -> its words
    roles: dict[str, str]  # word of a light's name -> the role of that light
    typed: dict[str, str]  # word that is typed in a hurry -> the word that is meant
    # kind of thing -> entry or adjective -> its entry at such a thing, if it has none of its own: "a calm lamp"
    elsewhere: dict[str, dict[str, str]]
    endings: dict[str, str]  # "comparative" or "superlative" -> ending of such words
    _made: dict[Callable[[Vocabulary], Any], Any] = field(init=False, repr=False, compare=False, default_factory=dict)

    def made(self, make: Callable[[Vocabulary], T]) -> T:
        """The object `make(self)`, which is made once and kept with the vocabulary."""
        if make not in self._made:
            self._made[make] = make(self)
        made: T = self._made[make]
        return made

    def entry(self, phrase: str) -> VocabularyEntry | None:
        """The entry of a phrase on its own; None where it is no look."""
        return self.entries.get(self.synonyms.get(phrase, ""))

    def opposite(self, entry: VocabularyEntry) -> VocabularyEntry | None:
        """The entry that an entry names as its opposite; None where it names none."""
        return self.entries.get(entry.opposite)

    def slot(self, phrase: str) -> str:
        """The slot of a phrase on its own; "" where it is no look."""
        entry = self.entry(phrase)
        return entry.slot if entry else ""

    def role(self, name: str) -> str:
        """The role of a light that words name: the key of "key light"; "" for none."""
        return next((self.roles[word] for word in name.split() if word in self.roles), "")

    def stems(self, word: str, degree: str) -> tuple[str, ...]:
        """Words that may have this comparative or superlative (`degree`): "cold" for "colder"; () for other words."""
        base = word.removesuffix(self.endings[degree])
        compares = base != word and len(base) > _SHORTEST_STEM
        return (base, base + "e", base[:-1], base[:-1] + "y") if compares else ()


@cache
def shipped_vocabulary() -> Vocabulary:
    """The shipped vocabulary, with the words of the rigs and phrases for hours."""
    folder = Path(__file__).parent
    text, colors = (folder / name for name in ("vocabulary.toml", "colors.txt"))
    vocabulary = load(text.read_text("utf-8"), colors.read_text("utf-8"))
    entries, synonyms = dict(vocabulary.entries), dict(vocabulary.synonyms)
    for rig in {rig.name: rig for rig in rig_table().rigs.values()}.values():
        known = next((entry for entry in rig.entries if entry in vocabulary.entries), rig.name)
        if known == rig.name:
            entries.setdefault(rig.name, VocabularyEntry(rig.name, "lighting", rig.words, phrase=rig.name))
        synonyms |= dict.fromkeys((word for word in rig.words if word not in vocabulary.entries), known)
    synonyms |= hour_phrases()
    return replace(vocabulary, entries=entries, synonyms=synonyms)


def load(text: str, colors: str) -> Vocabulary:
    """A vocabulary from the text of a .toml file and of a list of colors. Raises VibeError if something is wrong."""
    try:
        rows = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"The vocabulary cannot be read: {error}.", "Mend that line.") from error
    named = (line.rsplit(" ", 1) for line in colors.splitlines() if line and not line.startswith("#"))
    looks: dict[str, dict[str, Any]] = {normalize(name): row for name, row in rows["look"].items()}
    kelvins = range(_LEAST, _MOST + 1, _STEP)
    for kelvin in kelvins:
        tint = "warm" if kelvin < _WARM else "cool" if kelvin > _COOL else ""
        wishes = [f"light_color is {tint}"] if tint else []
        wishes.append(f"lights/temperature {kelvin * (1 - _REACH):.0f}..{kelvin * (1 + _REACH):.0f} !1")
        looks[kelvin_entry(kelvin)] = {"slot": "lighting", "wishes": wishes, "phrase": f"{tint or 'neutral'} light"}
    entries = {name: read_entry(name, row) for name, row in looks.items()}
    synonyms: dict[str, str] = {}
    for entry in entries.values():
        check_opposite(entry, entries)
        for word in entry.words:
            synonyms.setdefault(word, entry.name)
    synonyms |= {name: name for name in entries}  # in their order, which decides between equally near words
    adjectives = {normalize(w): {k: normalize(e) for k, e in kinds.items()} for w, kinds in rows["adjective"].items()}
    of_light = ("light", "fill", "rim", "otherwise")
    adjectives |= {name: dict.fromkeys(of_light, name) for name in map(kelvin_entry, kelvins)}
    elsewhere = {kind: _by_word(each) for kind, each in rows["elsewhere"].items()}
    said = [(word, name) for word, kinds in adjectives.items() for name in kinds.values()]
    said += [both for words in elsewhere.values() for both in words.items()]
    for word, name in said:
        if name not in entries:
            raise VibeError(f"Vocabulary: the word '{word}' names no entry '{name}'.", "Name an entry.")
    grammar = rows["grammar"]
    return Vocabulary(
        entries,
        synonyms,
        {normalize(name): srgb_from_hex(code) for name, code in named},
        {normalize(w): row for w, row in rows["shades"].items()},
        {normalize(w): strength for w, strength in grammar["intensity"].items()},
        {kind: frozenset(listed(words)) for kind, words in grammar["lists"].items()},
        _by_word(grammar["nouns"]),
        {kind: tuple(map(parse_effect, effects)) for kind, effects in rows["painted"].items()},
        adjectives,
        grammar.get("absent", {}),
        {kind: frozenset(listed(words)) for kind, words in grammar["words"].items()},
        _by_word(grammar["roles"]),
        _by_word(grammar["typed"]),
        elsewhere,
        grammar["endings"],
    )


def check_opposite(entry: VocabularyEntry, entries: Container[str]) -> None:
    """Raises VibeError if an entry names an opposite that is no entry."""
    if entry.opposite and normalize(entry.opposite) not in entries:
        problem = f"Vocabulary: '{entry.name}' has the unknown opposite '{entry.opposite}'."
        raise VibeError(problem, "Name an entry.")


@cache
def _hours() -> dict[str, Any]:
    return tomllib.loads(Path(__file__).with_name("hours.toml").read_text("utf-8"))


@cache
def hour_phrases() -> dict[str, str]:
    """Phrase for a time of day, or for a direction of light -> name of its entry."""
    return _by_word(_hours()["phrases"])


def hour_entry(hour: int) -> str:
    """The name of the entry for an hour of the clock, from 0 to 23: "night" for 3."""
    since: dict[str, str] = _hours()["from_hour"]
    return since[max((start for start in since if int(start) <= hour), key=int)]


def _by_word(rows: dict[str, str]) -> dict[str, str]:
    """Word -> the name of the row that lists it; in `rows`, name -> words, separated by commas."""
    return {word: name for name, words in rows.items() for word in listed(words)}


# Color temperatures as numbers: "3200 K key light", "a 5600 kelvin softbox"


def kelvin_entry(kelvins: float) -> str:
    """The name of the entry of the color temperature nearest to `kelvins`: "3200 kelvin"."""
    return f"{min(max(round(kelvins / _STEP) * _STEP, _LEAST), _MOST)} kelvin"


# The artist's own words


def default_vocabulary() -> Vocabulary:
    """The shipped vocabulary with the user's own on top. Raises VibeError if something in the user's file is wrong."""
    path = user_file()
    return _extended(path, path.stat().st_mtime_ns) if path else shipped_vocabulary()


@lru_cache(_VERSIONS)
def _extended(path: Path, changed: int) -> Vocabulary:
    return extend(shipped_vocabulary(), path)


def user_file() -> Path | None:
    """Path of the artist's own vocabulary; None without one. Raises VibeError if $VIBE_VOCABULARY names no file."""
    if named := os.environ.get(VARIABLE):
        path = Path(named).expanduser()
        if not path.is_file():
            remedy = f"Check --vocabulary, or the variable {VARIABLE}."
            raise VibeError(f"There is no vocabulary {named}.", remedy)
        return path
    path = config_folder() / "vocabulary.toml"
    return path if path.is_file() else None


def extend(base: Vocabulary, path: Path) -> Vocabulary:
    """A vocabulary with a user's file on top, whose words win. Raises VibeError with the line if the file is wrong."""
    text, rows = _read(path)
    entries, synonyms, colors = dict(base.entries), dict(base.synonyms), dict(base.colors)
    looks = rows.get("look", {})
    for name, row in looks.items():
        with _located(path, text, name):
            if not isinstance(row, dict):
                raise VibeError(f"'{name}' is not a table.", f'Write [look."{name}"] above its rows.')
            entries[normalize(name)] = read_entry(normalize(name), row)
    for name, own in ((name, entries[normalize(name)]) for name in looks):
        with _located(path, text, name):
            check_opposite(own, entries)
        synonyms |= dict.fromkeys(own.words, own.name)
        colors = {color: srgb for color, srgb in colors.items() if color not in own.words}
    for name, code in rows.get("colors", {}).items():
        if not is_hex(str(code)):
            raise at_line(path, text, f"'{code}' is not a color", 'Write it as "#rrggbb".', name)
        colors[normalize(name)] = srgb_from_hex(code)
    return replace(base, entries=entries, synonyms=synonyms, colors=colors)


def _read(path: Path) -> tuple[str, dict[str, Any]]:
    try:
        if path.stat().st_size > _LARGEST:
            raise VibeError(f"The vocabulary {path} is larger than 2 MB.", "Use a .toml of words.")
        text = path.read_text("utf-8")
        rows = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"The vocabulary {path} is not valid TOML: {error}.", "Mend that line.") from error
    except (OSError, UnicodeDecodeError) as error:
        remedy = "Save it as UTF-8 text."
        raise VibeError(f"The vocabulary {path} cannot be read: {error}.", remedy) from error
    for table, content in rows.items():
        if table not in ("look", "colors") or not isinstance(content, dict):
            remedy = "Use [look.NAME] or [colors]; these hold entries and color names."
            raise at_line(path, text, f"'{table}' is no part of a vocabulary", remedy, table)
    return text, rows


@contextmanager
def _located(path: Path, text: str, name: str) -> Iterator[None]:
    """Adds file and line to an error on the entry `name`; the line is found by the words that the error quotes."""
    try:
        yield
    except VibeError as error:
        what = error.message.removeprefix("Vocabulary: ").rstrip(".")
        quoted = (said for said in _QUOTED.findall(what) if said != name)
        raise at_line(path, text, what, error.remedy, name, *quoted) from error


def add_look(path: Path, name: str, rows: Mapping[str, str | Sequence[str]]) -> None:
    """Appends an entry to a file. If its name is taken or it is wrong, raises VibeError and keeps the file."""
    lines = [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in rows.items() if value]
    head = f"[look.{json.dumps(name, ensure_ascii=False)}]"
    _write(path, name, "\n".join([_text(path).rstrip("\n"), "", head, *lines, ""]).lstrip("\n"))


def add_color(path: Path, name: str, code: str) -> None:
    """Adds the color `code`, "#rrggbb", to a file; raises VibeError as `add_look` does."""
    text, line = _text(path), f"{json.dumps(name, ensure_ascii=False)} = {json.dumps(code)}\n"
    head = _COLORS.search(text)
    begun = text[: head.end()] if head else (text.rstrip("\n") + "\n\n[colors]\n").lstrip("\n")
    _write(path, name, begun + line + (text[head.end() :] if head else ""))


def _text(path: Path) -> str:
    return path.read_text("utf-8") if path.is_file() else ""


def _write(path: Path, name: str, text: str) -> None:
    """Replaces a file by `text`. Raises VibeError if `text` is no vocabulary, or if the file has `name` already."""
    key = json.dumps(name, ensure_ascii=False)
    if re.search(rf"^(\[look\.)?{re.escape(key)}[\] ]", _text(path), re.MULTILINE):
        raise VibeError(f"'{name}' is in {path} already.", "Change it there, or take another name.")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with atomic.replacing(path) as part:
            part.write_text(text, encoding="utf-8")
            try:
                extend(shipped_vocabulary(), part)
            except VibeError as error:
                raise VibeError(error.message.replace(str(part), str(path)), error.remedy) from error
    except OSError as error:
        remedy = "Name another file with --vocabulary."
        raise VibeError(f"{path} cannot be written: {error}.", remedy) from error
