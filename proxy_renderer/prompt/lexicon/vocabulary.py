# SPDX-License-Identifier: Apache-2.0
"""Loads vocabulary.toml and colors.txt into typed entries, and checks them against the schema."""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path

from ...color.floats import srgb_from_hex
from ...schema import FAMILIES, Values, VibeError
from . import kelvins
from .attributes import ATTRIBUTES

OWNERS = {
    "material": "material",
    "subject": "material",
    "surroundings": "material",
    "light": "light",
    "lights": "light",
    "key": "light",
    "fill": "light",
    "rim": "light",
    "others": "light",
    "world": "world",
    "volume": "volume",
    "film": "film",
}
"""Who an effect may name -> schema group."""
RANGE_MODES = ("", "times", "plus", "shade", "camera", "sides", "lightness", "aim", "share")
SLOTS = ("finish", "material", "color", "lighting", "atmosphere", "grade", "mood", "setting")
_TEXT: tuple[type, str] = (str, 'Write text in quotes: "...".')
_LIST: tuple[type, str] = (list, 'Write a list of effects: ["film/contrast 1.1..1.3 !2"].')
_CLAIMS: tuple[type, str] = (list, 'Write a list of claims: ["surroundings lightness ..14"].')
_HEADS: tuple[type, str] = (dict, 'Write { fog = "none" }.')
_ROWS = {
    "slot": _TEXT, "words": _TEXT, "do": _LIST, "means": _TEXT, "phrase": _TEXT, "opposite": _TEXT, "heads": _HEADS,
    "never": _LIST, "never_heads": _HEADS, "claims": _CLAIMS,
}  # fmt: skip
COLOR_MODES = ("color", "gel", "albedo", "shown", "cast")
_COLOR = re.compile(r"@|own|#[0-9a-fA-F]{6}")
_EFFECT = re.compile(
    r"(?P<owner>\w+)/(?P<name>\w+)(?: (?P<mode>[a-z]+))? (?P<args>\S+)(?P<weak> \?)?(?: !(?P<priority>\d+))?"
)


_SHORTEST_STEM = 2  # letters; a stem has more


@dataclass(frozen=True)
class Effect:
    """What a word does to one family of parameters; see the head of vocabulary.toml.

    Attributes:
        owner: A key of `OWNERS`.
        name: Parameter name within the group.
        mode: One of `RANGE_MODES` or `COLOR_MODES`.
        lower: One or three numbers; empty for color modes.
        upper: Likewise.
        color: For color modes: "@", "own", a color name or "#rrggbb".
        weak: Gives way silently to any other word.
        priority: 1 is the most important.
    """

    owner: str
    name: str
    mode: str
    lower: Values = ()
    upper: Values = ()
    color: str = ""
    weak: bool = False
    priority: int = 4

    @property
    def family(self) -> str:
        """The schema family: "material/roughness"."""
        return f"{OWNERS[self.owner]}/{self.name}"


@dataclass(frozen=True)
class VocabularyEntry:
    """One look word with its synonyms; see the head of vocabulary.toml."""

    name: str
    slot: str
    words: tuple[str, ...]
    effects: tuple[Effect, ...] = ()
    means: str = ""
    phrase: str = ""
    opposite: str = ""
    heads: dict[str, str] = field(default_factory=dict)
    never: tuple[Effect, ...] = ()
    never_heads: dict[str, str] = field(default_factory=dict)
    claims: tuple[str, ...] = ()


@dataclass(frozen=True)
class Vocabulary:
    """All that the parser and planner know.

    Attributes:
        entries: Name -> entry.
        synonyms: Phrase -> entry name.
        colors: Color name -> sRGB.
        shades: Shade word -> keyword arguments: lightness, towards, chroma, warmth.
        intensity: Phrase -> strength.
        lists: "negation", "link", "around", ... -> phrases.
        nouns: Phrase -> kind of thing.
        painted: Kind of thing -> what a color word does to it.
        adjectives: Word -> kind of thing (or "otherwise") -> entry name.
        absent: Kind of thing -> entry that the lack of it means: "no shadows".
        picks: Word -> which one of several it picks out, as in `fitted.picked_mentions`.
        typed: What is typed in a hurry -> the word that is meant.
        elsewhere: Kind of thing -> entry or adjective -> entry, where words say nothing of it themselves: "a calm lamp".
        endings: "comparative" or "superlative" -> how such words end.
    """

    entries: dict[str, VocabularyEntry]
    synonyms: dict[str, str]
    colors: dict[str, Values]
    shades: dict[str, dict[str, float]]
    intensity: dict[str, float]
    lists: dict[str, frozenset[str]]
    nouns: dict[str, str]
    painted: dict[str, tuple[Effect, ...]]
    adjectives: dict[str, dict[str, str]]
    absent: dict[str, str]
    picks: dict[str, str]
    typed: dict[str, str]
    elsewhere: dict[str, dict[str, str]]
    endings: dict[str, str]

    def stems(self, word: str, degree: str) -> tuple[str, ...]:
        """What a word may be made of if it compares: "cold" of "colder", "dry" of "drier".

        Args:
            word: The word.
            degree: "comparative" or "superlative".
        """
        base = word.removesuffix(self.endings[degree])
        compares = base != word and len(base) > _SHORTEST_STEM
        return (base, base + "e", base[:-1], base[:-1] + "y") if compares else ()


def as_meant(word: str) -> str:
    """A word as the readers have it: normalized, and spelled out where it was typed in a hurry."""
    plain = normalize(word)
    return shipped_vocabulary().typed.get(plain, plain)


def normalize(phrase: str) -> str:
    """Lower case and American, with hyphens and underscores as the lexer has them; "the lamp's" is "the lamp"."""
    lower = phrase.lower().replace("’", "'").replace("colour", "color")
    lower = re.sub(r"'s\b", "", lower)
    return " ".join(re.sub(r"[-_–—]", " ", lower).split())


def parse_effect(text: str) -> Effect:
    """Reads "material/roughness 0.03..0.15 ? !2".

    Raises:
        VibeError: It is not of that form, or names what the schema does not have.
    """
    match = _EFFECT.fullmatch(text.strip())
    problem = VibeError(
        f"Vocabulary: '{text}' is not an effect.", "Write 'OWNER/PARAMETER [MODE] LOWER..UPPER'."
    )
    if not match or match["owner"] not in OWNERS:
        raise problem
    mode = match["mode"] or ""
    weak, priority = bool(match["weak"]), int(match["priority"] or 4)
    effect = Effect(match["owner"], match["name"], mode, weak=weak, priority=priority)
    if effect.family not in FAMILIES:
        raise VibeError(
            f"Vocabulary: '{text}' names no parameter.", "See schema/parameters.py for those that exist."
        )
    if mode in COLOR_MODES:
        if not _COLOR.fullmatch(match["args"]):
            raise VibeError(
                f"Vocabulary: '{text}' has no color.", 'Write "#rrggbb", "@" or "own" at its end.'
            )
        return replace(effect, color=match["args"])
    lower, dots, upper = match["args"].partition("..")
    if mode not in RANGE_MODES or not dots:
        raise problem
    try:
        low, high = (tuple(float(v) for v in side.split(",")) for side in (lower, upper))
    except ValueError:
        raise problem from None
    if len(low) != len(high) or any(a > b for a, b in zip(low, high, strict=True)):
        raise VibeError(f"Vocabulary: '{text}' has a lower bound above the upper one.", "Swap them.")
    return replace(effect, lower=low, upper=high)


def read_entry(name: str, row: dict) -> VocabularyEntry:
    """One [look.NAME] table.

    Raises:
        VibeError: A row is missing, unknown, of the wrong type, or holds what the schema does not have.
    """
    _check_rows(name, row)
    words = [name, *row.get("words", "").split(",")]
    entry = VocabularyEntry(
        name,
        row["slot"],
        tuple(dict.fromkeys(normalize(w) for w in words if w.strip())),
        tuple(map(parse_effect, row.get("do", ()))),
        row.get("means", ""),
        row.get("phrase", name),
        row.get("opposite", ""),
        row.get("heads", {}),
        tuple(map(parse_effect, row.get("never", ()))),
        row.get("never_heads", {}),
        tuple(row.get("claims", ())),
    )
    for head, value in (*entry.heads.items(), *entry.never_heads.items()):
        if value not in ATTRIBUTES.get(head, ()):
            known = ", ".join(ATTRIBUTES.get(head, ())) or f"no such thing; there are {', '.join(ATTRIBUTES)}"
            raise VibeError(f"Vocabulary: '{value}' is no class of {head}.", f"Choose from: {known}.")
    return entry


def _check_rows(name: str, row: dict) -> None:
    for key, value in row.items():
        if key not in _ROWS:
            raise VibeError(
                f"Vocabulary: '{key}' is no row of an entry.", f"Use some of: {', '.join(_ROWS)}."
            )
        kind, remedy = _ROWS[key]
        parts = value if isinstance(value, list) else []
        if not isinstance(value, kind) or not all(isinstance(v, str) for v in parts):
            raise VibeError(f"Vocabulary: '{key}' of '{name}' has the wrong type.", remedy)
    if row.get("slot") not in SLOTS:
        raise VibeError(f"Vocabulary: '{name}' has no known slot.", f"Add slot = one of: {', '.join(SLOTS)}.")
    if not (row.get("do") or row.get("means")):
        raise VibeError(f"Vocabulary: '{name}' does nothing.", 'Give it a row do = [...] or means = "...".')


def _read_colors(text: str) -> dict[str, Values]:
    rows = (line.rsplit(" ", 1) for line in text.splitlines() if line and not line.startswith("#"))
    return {normalize(name): srgb_from_hex(code) for name, code in rows}


def load(text: str, colors: str) -> Vocabulary:
    """Builds a vocabulary from the text of a .toml file and of a color list.

    Raises:
        VibeError: Something in it is not what it should be; says what.
    """
    try:
        rows = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise VibeError(f"The vocabulary cannot be read: {error}.", "Mend that line.") from error
    looks = {normalize(name): row for name, row in rows["look"].items()} | kelvins.entries()
    entries = {name: read_entry(name, row) for name, row in looks.items()}
    grammar = rows["grammar"]
    synonyms: dict[str, str] = {}
    for entry in entries.values():
        for word in entry.words:
            synonyms.setdefault(word, entry.name)
    for name, entry in entries.items():
        synonyms[name] = name
        if entry.opposite and normalize(entry.opposite) not in entries:
            raise VibeError(
                f"Vocabulary: '{name}' has the unknown opposite '{entry.opposite}'.", "Name an entry."
            )
    adjectives = {
        normalize(w): {k: normalize(e) for k, e in kinds.items()} for w, kinds in rows["adjective"].items()
    } | kelvins.adjectives()
    for word, kinds in adjectives.items():
        for target in kinds.values():
            if target not in entries:
                raise VibeError(
                    f"Vocabulary: the adjective '{word}' names no entry '{target}'.", "Name an entry."
                )
    return Vocabulary(
        entries,
        synonyms,
        _read_colors(colors),
        {normalize(w): row for w, row in rows["shades"].items()},
        {normalize(w): strength for w, strength in grammar["intensity"].items()},
        {kind: frozenset(normalize(w) for w in words.split(",")) for kind, words in grammar["lists"].items()},
        {normalize(w): kind for kind, words in grammar["nouns"].items() for w in words.split(",")},
        {kind: tuple(map(parse_effect, effects)) for kind, effects in rows["painted"].items()},
        adjectives,
        grammar.get("absent", {}),
        _by_word(grammar["picks"]),
        _by_word(grammar["typed"]),
        _read_elsewhere(rows["elsewhere"], entries, adjectives),
        grammar["endings"],
    )


def _read_elsewhere(
    rows: dict[str, dict[str, str]],
    entries: dict[str, VocabularyEntry],
    adjectives: dict[str, dict[str, str]],
) -> dict[str, dict[str, str]]:
    """The rows of [elsewhere], by the words that they list."""
    found: dict[str, dict[str, str]] = {kind: {} for kind in rows}
    for kind, entry, word in (
        (k, e, normalize(w)) for k in rows for e in rows[k] for w in rows[k][e].split(",")
    ):
        if entry not in entries or (word not in entries and word not in adjectives):
            unknown = word if entry in entries else entry
            raise VibeError(
                f"Vocabulary: '{unknown}' at a {kind} is neither entry nor adjective.", "Name one."
            )
        if word in found[kind]:
            raise VibeError(f"Vocabulary: '{word}' at a {kind} is in two rows.", "Keep one.")
        found[kind][word] = entry
    return found


def _by_word(rows: dict[str, str]) -> dict[str, str]:
    """Each of the words of rows -> the name of its row."""
    return {normalize(word): name for name, words in rows.items() for word in words.split(",")}


@cache
def shipped_vocabulary() -> Vocabulary:
    """The vocabulary that is shipped."""
    folder = Path(__file__).parent
    text, colors = (folder / name for name in ("vocabulary.toml", "colors.txt"))
    return load(text.read_text("utf-8"), colors.read_text("utf-8"))
