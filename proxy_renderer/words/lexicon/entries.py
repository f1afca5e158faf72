# SPDX-License-Identifier: Apache-2.0
"""Entries of the vocabulary: look words with their wishes, read from tables and checked against the schema."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from operator import gt
from pathlib import Path
from typing import Any

from ...schema import FAMILIES, Values, VibeError
from ...schema.parameters import MEANS, SURFACES, Parameter, may_serve
from .quantities import ClaimText, quantities, read_claim

OWNERS = {
    **dict.fromkeys(("material", "subject", "surroundings"), "material"),
    **dict.fromkeys(("light", "lights", "key", "fill", "rim", "others"), "light"),
    **{group: group for group in ("world", "volume", "film")},
}
"""Owner that an effect may name -> schema group."""
RANGE_MODES = ("", "times", "plus", "near", "shade", "camera", "sides", "lightness", "share")
SLOTS = tuple(MEANS)
_LISTS = ("wishes", "never")  # rows of an entry that are lists; the others are text
_ROWS = ("slot", "words", "means", "phrase", "opposite", *_LISTS)
COLOR_MODES = ("color", "gel", "albedo", "shown", "cast")
_COLOR = re.compile(r"@|own|#[0-9a-fA-F]{6}")
_CLASS = re.compile(r"(?P<quantity>[a-z_]+) is (?P<named>[a-z_]+)")
_EFFECT = re.compile(
    r"(?P<owner>\w+)/(?P<name>\w+)(?: (?P<mode>[a-z]+))? (?P<args>\S+)(?P<weak> \?)?(?: !(?P<priority>\d+))?"
)
_NUMBERS = {"plus": 1, "near": 1, "camera": 1, "sides": 1, "lightness": 1, "share": 1, "shade": 2}
"""Mode -> count of numbers at each end of a range; for other modes, one or as many as the parameter has components."""
_LARGEST = 1e9


@dataclass(frozen=True)
class Effect:
    """Effect of a word on one family of parameters; see the head of vocabulary.toml."""

    owner: str  # a key of `OWNERS`
    name: str  # parameter name within the group
    mode: str  # one of `RANGE_MODES` or `COLOR_MODES`
    lower: Values = ()  # one or three numbers; empty for color modes
    upper: Values = ()  # likewise
    color: str = ""  # for color modes: "@", "own" or "#rrggbb"
    weak: bool = False  # is overridden by any other word, without a note
    priority: int = 4  # 1 is the most important

    @property
    def family(self) -> str:
        """The schema family: "material/roughness"."""
        return f"{OWNERS[self.owner]}/{self.name}"

    def __str__(self) -> str:
        """The effect as a text that `parse_effect` reads."""
        ends = "..".join(",".join(f"{v:.6g}" for v in end) for end in (self.lower, self.upper))
        mode = f" {self.mode}" if self.mode else ""
        weak = " ?" if self.weak else ""
        return f"{self.owner}/{self.name}{mode} {self.color or ends}{weak} !{self.priority}"


@dataclass(frozen=True)
class EntryWish:
    """A word's wish for one quantity."""

    quantity: str  # name in `quantities.toml`
    named: str = ""  # the class that it asks for: "glossy" of the finish; "" if it names none
    effects: tuple[Effect, ...] = ()  # what it does to parameters
    claims: tuple[ClaimText, ...] = ()  # on the image, in addition to those of the class


@dataclass(frozen=True)
class VocabularyEntry:
    """One look word with its synonyms; see the head of vocabulary.toml."""

    name: str
    slot: str
    words: tuple[str, ...]
    wishes: tuple[EntryWish, ...] = ()
    means: str = ""
    phrase: str = ""
    opposite: str = ""
    never: tuple[EntryWish, ...] = ()

    @property
    def effects(self) -> tuple[Effect, ...]:
        """The effects of all its wishes on parameters."""
        return tuple(effect for wish in self.wishes for effect in wish.effects)

    @property
    def classes(self) -> dict[str, str]:
        """Quantity -> the class that it asks for."""
        return {wish.quantity: wish.named for wish in self.wishes if wish.named}


def normalize(phrase: str) -> str:
    """A phrase in lower case and American spelling, with spaces for hyphens and underscores, and without "'s"."""
    lower = phrase.lower().replace("’", "'").replace("colour", "color")
    if lower.isalpha():
        return lower
    lower = re.sub(r"'s\b", "", lower)
    return " ".join(re.sub(r"[-_–—]", " ", lower).split())


def listed(text: str) -> tuple[str, ...]:
    """The words of a row, which commas separate: normalized, each once."""
    return tuple(dict.fromkeys(normalize(word) for word in text.split(",") if word.strip()))


def temperature(entry: str) -> int | None:
    """The kelvins of an entry that is called by them, "3200 kelvin"; None for others."""
    number, _, unit = entry.partition(" ")
    return int(number) if unit == "kelvin" and number.isdigit() else None


def at_line(path: Path | str, text: str, problem: str, remedy: str, *quotes: str) -> VibeError:
    """An error that names a line of a file: the last match when each quote is searched from the match before."""
    lines, line = text.splitlines(), 0
    for quoted in quotes:
        line = next((i for i in range(line, len(lines)) if quoted in lines[i]), line)
    return VibeError(f"{path}, line {line + 1}: {problem}.", remedy)


def parse_effect(text: str) -> Effect:
    """Reads "material/roughness 0.03..0.15 ? !2". Raises VibeError for a wrong form or a misfit of the schema."""
    match = _EFFECT.fullmatch(text.strip())
    form = _wrong(f"'{text}' is not an effect", "Write 'OWNER/PARAMETER [MODE] LOWER..UPPER'.")
    if not match or match["owner"] not in OWNERS:
        raise form
    mode, color = match["mode"] or "", ""
    low: Values = ()
    high: Values = ()
    parameter = FAMILIES.get(f"{OWNERS[match['owner']]}/{match['name']}")
    if parameter is None:
        raise _wrong(f"'{text}' names no parameter", "See schema/parameters.py for those that exist.")
    if mode in COLOR_MODES:
        if not _COLOR.fullmatch(match["args"]):
            raise _wrong(f"'{text}' has no color", 'Write "#rrggbb", "@" or "own" at its end.')
        color = match["args"]
    else:
        try:
            low, high = (tuple(float(v) for v in side.split(",")) for side in match["args"].split(".."))
        except ValueError:
            raise form from None
        if len(low) != len(high) or any(map(gt, low, high)):
            raise _wrong(f"'{text}' has a lower bound above the upper one", "Swap them.")
    if remedy := _misfit(parameter, mode, low, high):
        raise _wrong(f"'{text}' does not fit its parameter", remedy)
    weak, priority = bool(match["weak"]), int(match["priority"] or 4)
    return Effect(match["owner"], match["name"], mode, low, high, color, weak, priority)


def _wrong(problem: str, remedy: str) -> VibeError:
    return VibeError(f"Vocabulary: {problem}.", remedy)


def _misfit(parameter: Parameter, mode: str, lower: Values, upper: Values) -> str:
    """The remedy for an effect whose mode or range its parameter cannot have; "" if it fits. Colors have no range."""
    color, turns = parameter.kind == "color", parameter.name == "azimuth"
    light = parameter.name in ("power", "strength") and parameter.group in ("light", "world")
    fits = {"plus": not color, "shade": color, "camera": turns, "sides": turns, "share": light}
    fits |= dict.fromkeys(("", "times", "near"), True) | dict.fromkeys(("lightness", "shown"), color or light)
    if not fits.get(mode, color and mode in COLOR_MODES):
        return f"'{mode}' is no mode of {parameter.family}: use another, or none."
    counts = sorted({_NUMBERS[mode]} if mode in _NUMBERS else {1, parameter.components})
    if lower and len(lower) not in counts:
        return f"Write {' or '.join(map(str, counts))} numbers at each end, with commas between them."
    if not all(abs(v) <= _LARGEST for v in (*lower, *upper)):
        return f"Write finite numbers, at most {_LARGEST:g}."
    if mode == "times" and min(lower) < 0.0:
        return "Write no negative multiples."
    is_log = mode == "" and parameter.scale.name == "log"
    return "Write numbers above 0." if is_log and min(lower) <= 0.0 else ""


def read_entry(name: str, row: dict[str, Any]) -> VocabularyEntry:
    """The entry of one [look.NAME] table. Raises VibeError if a row is missing, unknown or wrong."""
    for key, value in row.items():
        if key not in _ROWS:
            raise _wrong(f"'{key}' is no row of an entry", f"Use some of: {', '.join(_ROWS)}.")
        texts = value if key in _LISTS and isinstance(value, list) else [value]
        if isinstance(value, list) != (key in _LISTS) or not all(isinstance(text, str) for text in texts):
            lists = 'Write a list: ["contrast is high", "film/contrast 1.1..1.3 !2"].'
            remedy = lists if key in _LISTS else 'Write text in quotes: "...".'
            raise _wrong(f"'{key}' of '{name}' has the wrong type", remedy)
    slot = row.get("slot")
    if slot not in SLOTS:
        raise _wrong(f"'{name}' has no known slot", f"Add slot = one of: {', '.join(SLOTS)}.")
    if not (row.get("wishes") or row.get("means")):
        raise _wrong(f"'{name}' does nothing", 'Give it a row wishes = [...] or means = "...".')
    for text in (*row.get("wishes", ()), *row.get("never", ())):
        if "/" in text and not may_serve(OWNERS[parse_effect(text).owner], slot):
            raise _wrong(
                f"'{name}' is of slot {slot} and may not change a material: '{text}'",
                f"Use light, world, volume or film, or give the entry one of the slots {', '.join(SURFACES)}.",
            )
    return VocabularyEntry(
        name,
        slot,
        listed(f"{name}, {row.get('words', '')}"),
        read_wishes(row.get("wishes", ())),
        row.get("means", ""),
        row.get("phrase", name),
        row.get("opposite", ""),
        read_wishes(row.get("never", ())),
    )


def read_wishes(texts: Iterable[str]) -> tuple[EntryWish, ...]:
    """Wishes of a word, one for each quantity, in the order of the texts. Raises VibeError for a text that is no wish.

    A text is a class ("finish is glossy"), an effect ("film/contrast 1.1..1.3 !2") or a claim ("thing gloss 12..").
    """
    found: dict[str, EntryWish] = {}
    table = quantities()

    def of(quantity: str) -> EntryWish:
        return found.get(quantity, EntryWish(quantity))

    for text in texts:
        if match := _CLASS.fullmatch(text.strip()):
            quantity, named = match["quantity"], match["named"]
            if quantity not in table.by_name:
                raise _wrong(f"'{text}' names no quantity", f"Choose from: {', '.join(table.by_name)}.")
            if named not in table.by_name[quantity].classes:
                classes = ", ".join(table.by_name[quantity].classes) or "none: write an effect or a claim"
                raise _wrong(f"'{named}' is no class of {quantity}", f"Choose from: {classes}.")
            found[quantity] = replace(of(quantity), named=named)
        elif "/" in text:
            effect = parse_effect(text)
            quantity = table.of_parameter(effect.owner, effect.family, effect.mode)
            found[quantity] = replace(of(quantity), effects=(*of(quantity).effects, effect))
        else:
            claim = read_claim(text)
            quantity = table.of_claim(claim)
            found[quantity] = replace(of(quantity), claims=(*of(quantity).claims, claim))
    return tuple(found.values())
