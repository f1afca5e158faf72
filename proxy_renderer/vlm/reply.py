# SPDX-License-Identifier: Apache-2.0
"""A model's answer, checked field by field: what is right is used, what is not is mended or dropped, and counted.

Nothing of an answer is ever run, opened or looked up: it is numbers, classes of ours, and short texts.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from ..color.floats import is_hex, srgb_from_hex
from ..planning.advice import Prompts
from ..planning.ranges import clip
from ..planning.types import PlanEntry
from ..schema import Instance, Values
from ..schema.parameters import Region
from ..words.lexicon.quantities import quantities
from ..words.types import PromptObject
from .request import REGIONS, SLOTS, AliasTable
from .transport import clean

_MOST_OBJECTS, _MOST_TEXTS, _MOST_ENTRIES = 12, 8, 200
_CAPTION, _WORD, _REASON = 160, 60, 160
_LAST = 99  # greatest priority
_NARROWEST = 0.04  # of the perceptual scale: a plan says where, the gradient where exactly
_DEGREES = 10.0  # likewise, of an angle
_NEGATION = re.compile(r"\b(no|not|never|without|n't)\b", re.IGNORECASE)


@dataclass
class Reply:
    """A model's proposals; fields are empty where its answer had nothing usable."""

    objects: list[PromptObject] = field(default_factory=list)  # what the look describes
    prompts: Prompts = field(default_factory=lambda: Prompts("", "", ""))  # captions; "" and () for none
    targets: dict[str, str] = field(default_factory=dict)  # quantity -> class
    colors: dict[Region, Values] = field(default_factory=dict)  # region -> sRGB that it should show
    ignored: list[str] = field(default_factory=list)  # words that no parameter can express
    entries: dict[str, PlanEntry] = field(default_factory=dict)  # key -> plan entry, within hard bounds
    keep: set[str] = field(default_factory=set)  # keys that should not move
    clipped: int = 0  # ranges that lay outside of their bounds, in part or entirely
    mended: int = 0  # ranges upside down or without width, and captions that the encoder would misread
    dropped: int = 0  # fields and entries that were of no use
    missing: int = 0  # fields that the schema has and the answer has not

    @property
    def useful(self) -> bool:
        """True if there is anything in it to go by."""
        return bool(self.entries or self.targets or self.colors or self.prompts.whole or self.prompts.subject)


def read_reply(raw: dict[str, Any], table: AliasTable) -> Reply:
    """Checks an answer."""
    reply = Reply()
    fields = ("objects", "prompts", "targets", "colors", "ignored", "plan", "keep")
    reply.missing = sum(name not in raw for name in fields)
    reply.dropped = len(set(raw) - set(fields))
    reply.objects = _objects(raw.get("objects"), table, reply)
    reply.prompts = _prompts(raw.get("prompts"), reply)
    classes = {name: quantity.classes for name, quantity in quantities().by_name.items()}
    reply.targets = _usable(raw.get("targets"), lambda name, text: text in classes.get(name, ()), reply)
    colors = _usable(raw.get("colors"), lambda name, text: name in REGIONS and is_hex(text), reply)
    reply.colors = {region: srgb_from_hex(text) for region, text in colors.items()}  # type: ignore[misc]
    reply.ignored = _texts(raw.get("ignored"), _WORD)
    for item in _list(raw.get("plan"), reply)[:_MOST_ENTRIES]:
        _add_entry(item, table, reply)
    for name in _list(raw.get("keep"), reply)[:_MOST_ENTRIES]:
        if isinstance(name, str) and name in table.rows:
            reply.keep.add(table.rows[name].key)
        else:
            reply.dropped += 1
    reply.keep -= set(reply.entries)
    return reply


def _objects(raw: Any, table: AliasTable, reply: Reply) -> list[PromptObject]:
    objects = []
    names = {t.id: i.owner for t in table.aliases for n, i in table.rows.items() if n.startswith(f"{t.id}/")}
    for item in _list(raw, reply)[:_MOST_OBJECTS]:
        region = item.get("region") if isinstance(item, dict) else None
        if region not in REGIONS:
            reply.dropped += 1
            continue
        attributes = item.get("attributes")
        attributes = attributes if isinstance(attributes, dict) else {}
        worn = item.get("materials")
        objects.append(
            PromptObject(
                clean(item.get("name"), _WORD) or region,
                region,
                {slot: words for slot in SLOTS if (words := clean(attributes.get(slot), _CAPTION))},
                tuple(
                    names[m]
                    for m in (worn if isinstance(worn, list) else [])
                    if isinstance(m, str) and m in names
                ),
            )
        )
    return objects


def _prompts(raw: Any, reply: Reply) -> Prompts:
    """Captions; one with a negation is no use to an encoder, which reads past the "no"."""
    given = raw if isinstance(raw, dict) else {}

    def usable(name: str) -> tuple[str, ...]:
        value = given.get(name)
        captions = _texts(value if isinstance(value, list) else [value], _CAPTION)
        fine = tuple(t for t in captions if not _NEGATION.search(t))
        reply.mended += len(captions) - len(fine)
        return fine

    subject, surroundings, whole = ("".join(usable(n)[:1]) for n in ("subject", "surroundings", "whole"))
    return Prompts(
        subject,
        surroundings,
        whole,
        *(usable(f"{name}_negatives") for name in ("subject", "surroundings", "whole")),
    )


def _usable(raw: Any, fits: Callable[[str, str], bool], reply: Reply) -> dict[str, str]:
    """The texts in an object that fit their names; others that are not empty are counted as dropped."""
    found = {}
    for name, value in (raw if isinstance(raw, dict) else {}).items():
        if isinstance(value, str) and fits(name, value.strip()):
            found[name] = value.strip()
        elif value not in ("", None):
            reply.dropped += 1
    return found


def _add_entry(item: Any, table: AliasTable, reply: Reply) -> None:
    """One entry of the plan, in the parameter's own unit, within its bounds, and with some width."""
    name = item.get("parameter") if isinstance(item, dict) else None
    instance = table.rows.get(name) if isinstance(name, str) else None
    if instance is None or instance.key in reply.entries:
        reply.dropped += 1
        return
    count = instance.parameter.components
    ends = [_numbers(item.get(side), count) for side in ("lower", "upper")]
    lower, upper = (e if e is not None else o for e, o in zip(ends, reversed(ends), strict=True))
    if lower is None or upper is None:
        reply.dropped += 1
        return
    least, most = table.bounds(instance)
    low, high = (tuple(min(max(v, least), most) for v in end) for end in (lower, upper))
    reply.clipped += (low, high) != (lower, upper)
    ordered = table.ordered(instance, low, high)
    planned = clip(*table.in_schema_units(instance, *ordered), instance)
    wide = widened(instance, *planned)
    reply.mended += None in ends or ordered != (low, high) or wide != planned
    priority = item.get("priority")
    number = priority if isinstance(priority, int) and not isinstance(priority, bool) else 5
    reason = clean(item.get("reason"), _REASON) or "part of the look"
    reply.entries[instance.key] = PlanEntry(*wide, min(max(number, 1), _LAST), f"model: {reason}", prior=0.0)


def widened(instance: Instance, lower: Values, upper: Values) -> tuple[Values, Values]:
    """A range with at least the least width on the perceptual scale, inside the parameter's bounds."""
    scale, angle = instance.parameter.scale, instance.parameter.kind == "angle"
    low, high = [], []
    for a, b, bottom, top in zip(lower, upper, instance.lower, instance.upper, strict=True):
        if top > bottom:
            u, v = scale.to_unit(a, bottom, top), scale.to_unit(b, bottom, top)
            least = min(_NARROWEST, _DEGREES / (top - bottom)) if angle else _NARROWEST
            if v - u < least:
                middle = min(max((u + v) / 2, least / 2), 1.0 - least / 2)
                a = max(scale.from_unit(middle - least / 2, bottom, top), bottom)
                b = min(scale.from_unit(middle + least / 2, bottom, top), top)
        low.append(a)
        high.append(b)
    return tuple(low), tuple(high)


def _numbers(raw: Any, count: int) -> Values | None:
    """So many finite numbers, or one that stands for all of them."""
    given = raw if isinstance(raw, list) else [raw]
    if len(given) == 1:
        given = given * count
    if len(given) != count:
        return None
    try:
        values = tuple(float(v) for v in given if isinstance(v, int | float) and not isinstance(v, bool))
    except OverflowError:
        return None
    return values if len(values) == count and all(map(math.isfinite, values)) else None


def _texts(raw: Any, longest: int) -> list[str]:
    cleaned = (clean(t, longest) for t in (raw if isinstance(raw, list) else []))
    return [t for t in dict.fromkeys(cleaned) if t][:_MOST_TEXTS]


def _list(raw: Any, reply: Reply) -> list[Any]:
    if isinstance(raw, list):
        return raw
    reply.dropped += raw is not None
    return []
