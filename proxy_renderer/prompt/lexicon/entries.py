# SPDX-License-Identifier: Apache-2.0
"""Entries of the vocabulary: look words with what they do, read from tables and checked against the schema."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace

from ...schema import FAMILIES, Values, VibeError
from ...schema.means import MEANS, PAINT, may_serve
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
RANGE_MODES = ("", "times", "plus", "shade", "camera", "sides", "lightness", "share")
SLOTS = tuple(MEANS)
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
    for text in (*row.get("do", ()), *row.get("never", ())):
        _check_means(name, entry.slot, text)
    return entry


def _check_means(name: str, slot: str, text: str) -> None:
    """Raises VibeError where an effect is no means that words of a slot have."""
    if may_serve(OWNERS[parse_effect(text).owner], slot):
        return
    surfaces = ", ".join(each for each, groups in MEANS.items() if PAINT in groups)
    raise VibeError(
        f"Vocabulary: '{name}' is of slot {slot} and may not change a material: '{text}'.",
        f"Remove that effect and use light, world, volume or film, or give the entry one of the slots {surfaces}.",
    )


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
