# SPDX-License-Identifier: Apache-2.0
"""Entries of the vocabulary: look words with their wishes, read from tables and checked against the schema."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

from ...schema import FAMILIES, Values, VibeError
from ...schema.parameters import MEANS, SURFACES, Parameter, may_serve
from .quantities import ClaimText, quantities, read_claim

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
RANGE_MODES = ("", "times", "plus", "shade", "camera", "sides", "lightness", "share")
SLOTS = tuple(MEANS)
_TEXT: tuple[type, str] = (str, 'Write text in quotes: "...".')
_LIST: tuple[type, str] = (list, 'Write a list: ["contrast is high", "film/contrast 1.1..1.3 !2"].')
_ROWS = {
    "slot": _TEXT, "words": _TEXT, "wishes": _LIST, "means": _TEXT, "phrase": _TEXT, "opposite": _TEXT, "never": _LIST,
}  # fmt: skip
_FORMER = {"do": "wishes", "heads": "wishes", "claims": "wishes", "never_heads": "never"}
"""Rows of earlier versions -> where their content stands now."""
COLOR_MODES = ("color", "gel", "albedo", "shown", "cast")
_COLOR = re.compile(r"@|own|#[0-9a-fA-F]{6}")
_CLASS = re.compile(r"(?P<quantity>[a-z_]+) is (?P<named>[a-z_]+)")
_EFFECT = re.compile(
    r"(?P<owner>\w+)/(?P<name>\w+)(?: (?P<mode>[a-z]+))? (?P<args>\S+)(?P<weak> \?)?(?: !(?P<priority>\d+))?"
)


_NUMBERS = {"plus": 1, "camera": 1, "sides": 1, "lightness": 1, "share": 1, "shade": 2}
"""Mode -> how many numbers an end of a range has; of other modes one, or as many as the parameter has components."""
_LARGEST = 1e9


@dataclass(frozen=True)
class Effect:
    """What a word does to one family of parameters; see the head of vocabulary.toml."""

    owner: str  # a key of `OWNERS`
    name: str  # parameter name within the group
    mode: str  # one of `RANGE_MODES` or `COLOR_MODES`
    lower: Values = ()  # one or three numbers; empty for color modes
    upper: Values = ()  # likewise
    color: str = ""  # for color modes: "@", "own" or "#rrggbb"
    weak: bool = False  # gives way silently to any other word
    priority: int = 4  # 1 is the most important

    @property
    def family(self) -> str:
        """The schema family: "material/roughness"."""
        return f"{OWNERS[self.owner]}/{self.name}"

    def __str__(self) -> str:
        """As `parse_effect` reads it."""
        ends = "..".join(",".join(f"{v:.6g}" for v in end) for end in (self.lower, self.upper))
        mode = f" {self.mode}" if self.mode else ""
        weak = " ?" if self.weak else ""
        return f"{self.owner}/{self.name}{mode} {self.color or ends}{weak} !{self.priority}"


@dataclass(frozen=True)
class EntryWish:
    """What a word wishes of one quantity."""

    quantity: str  # name in `quantities.toml`
    named: str = ""  # the class that it asks for: "glossy" of the finish; "" if it names none
    effects: tuple[Effect, ...] = ()  # what it does to parameters
    claims: tuple[ClaimText, ...] = ()  # what the image has to look like, beside what the class claims


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
        """All that it does to parameters."""
        return tuple(effect for wish in self.wishes for effect in wish.effects)

    @property
    def classes(self) -> dict[str, str]:
        """Quantity -> the class that it asks for."""
        return {wish.quantity: wish.named for wish in self.wishes if wish.named}

    @property
    def is_colored(self) -> bool:
        """Whether it is a material with a color of its own: oak."""
        return self.slot == "material" and any(e.name == "base_color" for e in self.effects)


def normalize(phrase: str) -> str:
    """Lower case and American, with hyphens and underscores as the lexer has them; "the lamp's" is "the lamp"."""
    lower = phrase.lower().replace("’", "'").replace("colour", "color")
    if lower.isalpha():
        return lower
    lower = re.sub(r"'s\b", "", lower)
    return " ".join(re.sub(r"[-_–—]", " ", lower).split())


def temperature(entry: str) -> int | None:
    """The kelvins of an entry that is called by them, "3200 kelvin"; None for others."""
    number, _, unit = entry.partition(" ")
    return int(number) if unit == "kelvin" and number.isdigit() else None


def at_line(path: Path, text: str, problem: str, remedy: str, *quotes: str) -> VibeError:
    """An error that names a line of a file.

    Args:
        quotes: Texts that lead to the line: the first line that has the first, from there on the first that has the second.
    """
    lines, line = text.splitlines(), 0
    for quoted in quotes:
        line = next((i for i in range(line, len(lines)) if quoted in lines[i]), line)
    return VibeError(f"{path}, line {line + 1}: {problem}.", remedy)


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
        _check_fit(text, effect)
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
    effect = replace(effect, lower=low, upper=high)
    _check_fit(text, effect)
    return effect


def _check_fit(text: str, effect: Effect) -> None:
    """Raises VibeError where the parameter of an effect has no such mode, or no such numbers."""
    if remedy := _misfit(FAMILIES[effect.family], effect.mode, effect.lower, effect.upper):
        raise VibeError(f"Vocabulary: '{text}' does not fit its parameter.", remedy)


def _misfit(parameter: Parameter, mode: str, lower: Values, upper: Values) -> str:
    """The remedy for an effect whose mode or numbers its parameter cannot have; "" for one that fits.

    Args:
        lower: Of its range; empty for colors.
    """
    color = parameter.kind == "color"
    light = parameter.name in ("power", "strength") and parameter.group in ("light", "world")
    fits = {
        "": True,
        "times": True,
        "plus": not color,
        "shade": color,
        "camera": parameter.name == "azimuth",
        "sides": parameter.name == "azimuth",
        "lightness": color or light,
        "share": light,
        "shown": color or light,
    }
    if not fits.get(mode, color):
        return f"'{mode}' is no mode of {parameter.family}: use another, or none."
    if not lower:
        return ""
    counts = sorted({_NUMBERS[mode]} if mode in _NUMBERS else {1, parameter.components})
    if len(lower) not in counts:
        return f"Write {' or '.join(map(str, counts))} numbers at each end, with commas between them."
    if not all(abs(v) <= _LARGEST for v in (*lower, *upper)):
        return f"Write finite numbers, at most {_LARGEST:g}."
    if mode == "times" and min(lower) < 0.0:
        return "Write no negative multiples."
    if mode == "" and parameter.scale.name == "log" and min(lower) <= 0.0:
        return "Write numbers above 0."
    return ""


def read_entry(name: str, row: dict) -> VocabularyEntry:
    """One [look.NAME] table.

    Raises:
        VibeError: A row is missing, unknown, of the wrong type, or holds what the schema does not have.
    """
    _check_rows(name, row)
    words = [name, *row.get("words", "").split(",")]
    for text in (*row.get("wishes", ()), *row.get("never", ())):
        _check_means(name, row["slot"], text)
    return VocabularyEntry(
        name,
        row["slot"],
        tuple(dict.fromkeys(normalize(w) for w in words if w.strip())),
        read_wishes(row.get("wishes", ())),
        row.get("means", ""),
        row.get("phrase", name),
        row.get("opposite", ""),
        read_wishes(row.get("never", ())),
    )


def read_wishes(texts: Iterable[str]) -> tuple[EntryWish, ...]:
    """Reads the wishes of a word, grouped by their quantities in the order in which these are named first.

    Args:
        texts: Classes ("finish is glossy"), effects ("film/contrast 1.1..1.3 !2") and claims ("thing gloss 12..").

    Raises:
        VibeError: One of them is none of the three.
    """
    found: dict[str, EntryWish] = {}
    table = quantities()
    for text in texts:
        if named := _CLASS.fullmatch(text.strip()):
            _check_class(text, named["quantity"], named["named"])
            now = found.setdefault(named["quantity"], EntryWish(named["quantity"]))
            found[now.quantity] = replace(now, named=named["named"])
        elif "/" in text:
            effect = parse_effect(text)
            quantity = table.of_parameter(effect.owner, effect.family, effect.mode)
            now = found.setdefault(quantity, EntryWish(quantity))
            found[quantity] = replace(now, effects=(*now.effects, effect))
        else:
            claim = read_claim(text)
            quantity = table.of_claim(claim)
            now = found.setdefault(quantity, EntryWish(quantity))
            found[quantity] = replace(now, claims=(*now.claims, claim))
    return tuple(found.values())


def _check_class(text: str, quantity: str, named: str) -> None:
    """Raises VibeError where a quantity does not exist, or has no such class."""
    known = quantities().by_name
    if quantity not in known:
        raise VibeError(f"Vocabulary: '{text}' names no quantity.", f"Choose from: {', '.join(known)}.")
    if named not in known[quantity].classes:
        classes = ", ".join(known[quantity].classes) or "none: write an effect or a claim"
        raise VibeError(f"Vocabulary: '{named}' is no class of {quantity}.", f"Choose from: {classes}.")


def _check_means(name: str, slot: str, text: str) -> None:
    """Raises VibeError where an effect is no means that words of a slot have."""
    if "/" not in text or may_serve(OWNERS[parse_effect(text).owner], slot):
        return
    surfaces = ", ".join(SURFACES)
    raise VibeError(
        f"Vocabulary: '{name}' is of slot {slot} and may not change a material: '{text}'.",
        f"Remove that effect and use light, world, volume or film, or give the entry one of the slots {surfaces}.",
    )


def _check_rows(name: str, row: dict) -> None:
    for key, value in row.items():
        if key in _FORMER:
            raise VibeError(
                f"Vocabulary: the row '{key}' of '{name}' is of an earlier version.",
                f'Write its content into a row {_FORMER[key]} = [...]; classes as "finish is glossy".',
            )
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
    if not (row.get("wishes") or row.get("means")):
        raise VibeError(
            f"Vocabulary: '{name}' does nothing.", 'Give it a row wishes = [...] or means = "...".'
        )
