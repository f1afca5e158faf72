# SPDX-License-Identifier: Apache-2.0
"""Goals as JSON, written and read: the format of docs/reference/goals.md."""

import json
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar, get_args

from ..color.floats import hex_from_srgb, is_hex, srgb_from_hex
from ..schema import VibeError
from ..schema.errors import quoted
from ..schema.parameters import PICTURE, Region, may_serve
from ..words.lexicon.entries import OWNERS, SLOTS, parse_effect
from ..words.lexicon.quantities import ClaimText, quantities, read_claim
from ..words.lexicon.vocabulary import shipped_vocabulary
from ..words.targets import ROLES as NAMED_ROLES
from ..words.types import GLOW, STRONGEST, Attribute, Parsed, PromptObject, SceneDescription
from .resolve import Goals, resolved
from .wish import Wish, breadth_of

T = TypeVar("T")
_SHOWN = 60  # characters of a quotation in a message, at most
_TYPES = {
    str: "a text in quotes",
    float: "a finite number",
    bool: "true or false",
    list: "a list",
    dict: "an object {...}",
}


class JsonFields:
    """Takes and checks the fields of a JSON object; a wrong one raises VibeError with the `place`: "goals.words[2]"."""

    def __init__(self, raw: Any, place: str) -> None:
        if not isinstance(raw, dict):
            raise VibeError(f"{place} is no object.", "Write {...} there.")
        self.raw, self.place = raw, place
        self._taken: set[str] = set()

    def take(self, name: str, kind: type, default: Any = None) -> Any:
        """The value of field `name`, which has to be of type `kind`; `default` if the field is missing."""
        self._taken.add(name)
        value = self.raw.get(name, default)
        if value is None:
            raise VibeError(f"{self.place} has no '{name}'.", f"Add it: {_TYPES[kind]}.")
        if kind is float and _is_number(value):
            return float(value)
        if not isinstance(value, kind):
            raise VibeError(f"{self.place}.{name} is of the wrong type.", f"Write {_TYPES[kind]}.")
        return value

    def named(self, name: str) -> str:
        """The text of field `name`, which has to be there and not empty."""
        value: str = self.take(name, str)
        if not value.strip():
            raise VibeError(f"{self.place}.{name} is empty.", "Write a word.")
        return value

    def number(self, name: str, default: float, least: float = -math.inf, most: float = math.inf) -> float:
        """The number of field `name`, from `least` to `most`; `default` if the field is missing."""
        value: float = self.take(name, float, default)
        if not least <= value <= most:
            remedy = f"Write a number from {least:g} to {most:g}."
            raise VibeError(f"{self.place}.{name} is {value:g}.", remedy)
        return value

    def choice(self, name: str, known: tuple[str, ...], default: str | None = None) -> str:
        """The text of field `name`, which has to be one of `known`; `default` if the field is missing."""
        value: str = self.take(name, str, default)
        if value not in known:
            remedy = f"Choose from: {', '.join(known)}."
            raise VibeError(f"{self.place}.{name} is {quoted(value, _SHOWN)}.", remedy)
        return value

    def texts(self, name: str) -> list[str]:
        """The list of texts of field `name`; empty if the field is missing."""
        values: list[Any] = self.take(name, list, [])
        if not all(isinstance(value, str) for value in values):
            raise VibeError(f"{self.place}.{name} holds something else than texts.", 'Write ["...", "..."].')
        return values

    def numbers(self, name: str) -> tuple[int, ...]:
        """The whole numbers of field `name`; empty if the field is missing."""
        values: list[Any] = self.take(name, list, [])
        if not all(isinstance(value, int) and not isinstance(value, bool) for value in values):
            raise VibeError(f"{self.place}.{name} holds something else than whole numbers.", "Write [1, 2].")
        return tuple(values)

    def shades(self) -> tuple[tuple[float, float, float, float], ...]:
        """The field "shades": rows of four arguments of `color.shade`, for a material's own color; empty if missing."""
        rows: list[Any] = self.take("shades", list, [])
        if not all(
            isinstance(row, list) and len(row) == 4 and all(_is_number(v) and abs(v) <= 200.0 for v in row)
            for row in rows
        ):
            problem = f"{self.place}.shades holds something else than lists of four small numbers."
            raise VibeError(problem, "Write lightness, chroma, L* and warmth of each: [[0.6, 1, 20, 0]].")
        return tuple((float(a), float(b), float(c), float(d)) for a, b, c, d in rows)

    def each(self, name: str, read_text: Callable[[str], T]) -> tuple[T, ...]:
        """The texts of field `name`, each read by `read_text`; messages of its errors begin with the field's place."""
        try:
            return tuple(map(read_text, self.texts(name)))
        except VibeError as error:
            message = " ".join(error.message.removeprefix("Vocabulary: ").split())
            raise VibeError(f"{self.place}.{name}: {message}", error.remedy) from error

    def end(self) -> None:
        """Raises VibeError if there are fields that nothing has taken: they would be ignored."""
        if unknown := sorted(self.raw.keys() - self._taken):
            problem = f"{self.place} has an unknown field {quoted(unknown[0], _SHOWN)}."
            raise VibeError(problem, f"Known are: {', '.join(sorted(self._taken))}.")


def _is_number(value: Any) -> bool:
    """True if a value is a number within a float's range; JSON integers may be too large for that."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


VERSION = 1  # of the format
_LARGEST, _MOST = 2_000_000, 500  # bytes of a file, and words in it
_REGIONS: tuple[str, ...] = get_args(Region)
KINDS = (*(kind for kind in shipped_vocabulary().painted if not kind.startswith("hidden")), "whole")
"""Kinds of targets that a word may have: all that a color word can describe, and "whole" for the whole image."""
ROLES = ("", *NAMED_ROLES, "others")  # roles of the lights that a word may describe
_HELP = "Write a new file with `vibe explain PROMPT --goals`, and change that; docs/reference/goals.md has all fields."


def as_json(goals: Goals) -> dict[str, Any]:
    """Goals as a JSON object: each word with its target and wishes, and for each overridden wish the word that wins."""
    wishes = [*goals.wishes, *(each.wish for each in goals.lost)]
    won = {id(each.wish): each.winner.word for each in goals.lost}
    words = {id(a): a for a in (*goals.parsed.attributes, *(wish.attribute for wish in wishes))}
    return {
        "version": VERSION,
        "prompt": goals.parsed.prompt,
        "objects": [{"name": each.name, "region": each.region} for each in goals.parsed.objects],
        "stays": list(goals.parsed.protected),
        **({"holds": True} if goals.holds else {}),
        "words": [
            _word(a)
            | ({"vague": True} if any(w.vague for w in wishes if id(w.attribute) == key) else {})
            | {"wishes": [_wish(w, won.get(id(w))) for w in wishes if id(w.attribute) == key]}
            for key, a in words.items()
        ],
    }


def _word(attribute: Attribute) -> dict[str, Any]:
    """The fields of a word and of its target; most fields with their default value are left out."""
    target = {
        "kind": attribute.kind,
        "region": attribute.region,
        "thing": attribute.thing,
        "materials": list(attribute.owners),
        "lights": list(attribute.lights),
        "role": attribute.role,
        "described": list(attribute.phrases),
    }
    return {
        "word": attribute.word,
        "look": attribute.entry,
        "slot": attribute.slot,
        "target": {name: value for name, value in target.items() if value or name in ("kind", "region")},
        **({"color": hex_from_srgb(attribute.color)} if attribute.color else {}),
        **({"strength": round(attribute.strength, 6)} if attribute.strength != 1.0 else {}),
        **({"denied": True} if attribute.negated else {}),
        **({"implied_by": attribute.cause} if attribute.cause else {}),
        **({"shades": [list(each) for each in attribute.shades]} if attribute.shades else {}),
        **({"english": attribute.english} if attribute.english else {}),
    }


def _wish(wish: Wish, winner: str | None) -> dict[str, Any]:
    return {
        "quantity": wish.quantity,
        **({"class": wish.named} if wish.named else {}),
        **({"toward": wish.toward} if wish.toward not in ("", wish.named) else {}),
        **({"parameters": [str(effect) for effect in wish.effects]} if wish.effects else {}),
        **({"image": [str(claim) for claim in wish.claims]} if wish.claims else {}),
        **({"strength": round(wish.strength, 6)} if wish.strength != wish.attribute.strength else {}),
        **({"gave_way_to": winner} if winner is not None else {}),
    }


@dataclass(frozen=True)
class WrittenGoals:
    """Goals from a file that are not bound to a scene yet."""

    prompt: str
    objects: tuple[PromptObject, ...]  # objects that the prompt names; if none, the scene's subject is taken
    stays: tuple[str, ...]  # owners of parameters that stay as they are
    wishes: tuple[Wish, ...]
    attributes: tuple[Attribute, ...]  # all words, also those without wishes, such as names of rigs
    holds: bool = False  # whether the rest of the image stays as it is

    def within(self, words: SceneDescription) -> Goals:
        """The goals, bound to the scene that `words` describes, with notes on materials and lights that it lacks."""
        known = {*words.lights, *(f"{GLOW}{name}" for name in words.glows)}
        bound, gone, notes = dict[int, Attribute](), set[int](), list[str]()
        for a in self.attributes:
            owners = tuple(name for name in a.owners if name in words.materials)
            lights = tuple(name for name in a.lights if name in known)
            bound[id(a)] = replace(a, owners=owners, lights=lights)
            # A word for what the scene lacks describes the whole region or kind; a reference image's word is left out.
            left_out = a.slot == PICTURE and a.owners and not owners
            gone |= {id(a)} if left_out else set()
            missing = [name for name in a.owners if name not in owners]
            if missing := missing + [name for name in a.lights if name not in lights]:
                what = "is left out" if left_out else f"describes the {a.kind} instead"
                notes.append(f"'{a.word}' described {', '.join(missing)}, which this scene lacks: it {what}.")
        objects = [*self.objects] or [PromptObject(words.subject or "subject", "subject")]
        said = [a for a in bound.values() if a.slot != PICTURE]
        parsed = Parsed(self.prompt, objects, said, notes=notes, protected=self.stays)
        left = (wish for wish in self.wishes if id(wish.attribute) not in gone)
        wishes = [replace(wish, attribute=bound[id(wish.attribute)]) for wish in left]
        return replace(resolved(parsed, wishes), holds=self.holds)


def read(path: Path) -> WrittenGoals:
    """Goals from a file (goals, preset or report). Raises VibeError if it cannot be read or a field is wrong."""
    try:
        if path.stat().st_size > _LARGEST:
            raise VibeError(f"The goals {path} are larger than {_LARGEST // 1_000_000} MB.", _HELP)
        raw = json.loads(path.read_text("utf-8"))
    except OSError as error:
        raise VibeError(f"The goals {path} cannot be read: {error.strerror}.", "Check --goals.") from error
    except (ValueError, RecursionError) as error:
        raise VibeError(f"The goals {path} are no JSON: {error}.", _HELP) from error
    if isinstance(raw, dict) and "words" not in raw and not (raw := raw.get("goals")):
        raise VibeError(f"The file {path} has neither words nor goals.", _HELP)
    return from_json(raw)


def from_json(raw: Any) -> WrittenGoals:
    """Goals from a parsed JSON value. Raises VibeError if a field is missing, unknown or wrong."""
    goals = JsonFields(raw, "goals")
    if (version := goals.number("version", VERSION)) != VERSION:
        raise VibeError(f"These goals are of version {version:g}; this is version {VERSION}.", _HELP)
    rows = goals.take("words", list, [])
    if not rows or len(rows) > _MOST:
        raise VibeError(f"goals.words has {len(rows)} words.", f"Write 1 to {_MOST} of them.")
    prompt = goals.take("prompt", str, "")
    objects = []
    for number, row in enumerate(goals.take("objects", list, [])):
        thing = JsonFields(row, f"goals.objects[{number}]")
        objects.append(PromptObject(thing.named("name"), thing.choice("region", _REGIONS)))  # type: ignore[arg-type]
        thing.end()
    stays, holds = tuple(goals.texts("stays")), goals.take("holds", bool, False)
    goals.end()
    attributes, wishes = [], []
    for number, row in enumerate(rows):
        attribute, own = _read_word(JsonFields(row, f"goals.words[{number}]"))
        attributes.append(attribute)
        wishes += own
    return WrittenGoals(prompt, tuple(objects), stays, tuple(wishes), tuple(attributes), holds)


def _read_word(word: JsonFields) -> tuple[Attribute, list[Wish]]:
    target = JsonFields(word.take("target", dict, {}), f"{word.place}.target")
    color = word.take("color", str, "")
    if color and not is_hex(color):
        raise VibeError(f"{word.place}.color is {quoted(color, _SHOWN)}.", 'Write it as "#rrggbb".')
    attribute = Attribute(
        word=word.named("word"),
        entry=word.take("look", str, ""),
        slot=word.choice("slot", (*SLOTS, PICTURE)),
        region=target.choice("region", _REGIONS, "subject"),  # type: ignore[arg-type]
        kind=target.choice("kind", KINDS, "subject"),
        strength=word.number("strength", 1.0, 0.0, STRONGEST),
        negated=word.take("denied", bool, False),
        owners=tuple(target.texts("materials")),
        role=target.choice("role", ROLES, ""),
        color=srgb_from_hex(color) if color else None,
        thing=target.take("thing", str, ""),
        cause=word.take("implied_by", str, ""),
        phrases=target.numbers("described"),
        lights=tuple(target.texts("lights")),
        shades=word.shades(),
        english=word.take("english", str, ""),
    )
    vague = word.take("vague", bool, False)
    rows = word.take("wishes", list, [])
    target.end()
    word.end()
    fields = (JsonFields(row, f"{word.place}.wishes[{n}]") for n, row in enumerate(rows))
    wishes = [_read_wish(each, attribute) for each in fields]
    breadth = 0 if attribute.slot == PICTURE else breadth_of(wishes)
    return attribute, [replace(wish, breadth=breadth, vague=vague) for wish in wishes]


def _read_wish(row: JsonFields, attribute: Attribute) -> Wish:
    """A checked wish. The field "gave_way_to" is ignored: which wishes are overridden is decided anew."""
    quantity = row.choice("quantity", tuple(quantities().by_name))
    classes = tuple(quantities().by_name[quantity].classes)
    named = row.choice("class", classes) if "class" in row.raw else ""
    toward = row.choice("toward", classes) if "toward" in row.raw else "" if attribute.color else named
    row.take("gave_way_to", str, "")
    effects = row.each("parameters", parse_effect)
    for effect in effects:
        if not may_serve(OWNERS[effect.owner], attribute.slot, attribute.cause):
            problem = f"{row.place}.parameters: a word of slot {attribute.slot} may not change a material: '{effect}'."
            raise VibeError(problem, "Remove it, or give the word the slot color, material or finish.")
        if attribute.slot == PICTURE and effect.mode not in ("", "times", "plus"):
            problem = f"{row.place}.parameters: a reference image cannot have '{effect}'."
            raise VibeError(problem, "Write LOWER..UPPER, alone or after times or plus.")
    claims = row.each("image", _read_claim)
    if not attribute.color and not (effects or claims or named):
        raise VibeError(f"{row.place} wishes for nothing.", "Give it a class, parameters or image.")
    strength = row.number("strength", attribute.strength, 0.0, STRONGEST)
    row.end()
    return Wish(attribute, quantity, named, toward, effects, claims, strength)


def _read_claim(text: str) -> ClaimText:
    claim = read_claim(text)
    quantities().of_claim(claim)  # refuses a measure that does not exist
    return claim
