# SPDX-License-Identifier: Apache-2.0
"""A model's answer, checked field by field: what is right is used, what is not is mended or dropped, and counted.

Nothing of an answer is ever run, opened or looked up: it is numbers, classes of ours, and short texts.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import Any

from ..color.floats import is_hex, srgb_from_hex
from ..planning.captions import Prompts
from ..planning.ranges import clip
from ..planning.types import PlanEntry
from ..schema import Instance, Values
from ..schema.spec import Region
from ..words.lexicon.quantities import quantities
from ..words.types import PromptObject
from .aliases import AliasTable
from .extract import clean
from .request import REGIONS, SLOTS

_MOST_OBJECTS, _MOST_TEXTS, _MOST_ENTRIES = 12, 8, 200
_CAPTION, _WORD, _REASON = 160, 60, 160
_LAST = 99  # greatest priority
_NARROWEST = 0.04  # of the perceptual scale: a plan says where, the gradient where exactly
_DEGREES = 10.0  # likewise, of an angle
_NEGATION = re.compile(r"\b(no|not|never|without|n't)\b", re.IGNORECASE)


@dataclass
class Reply:
    """A model's proposals; fields are empty where its answer had nothing usable.

    Attributes:
        objects: What the look describes.
        prompts: Captions; "" and () where there is none.
        targets: Quantity -> class.
        colors: Region -> sRGB that it should show.
        ignored: Words that no parameter can express.
        entries: Key -> plan entry, within hard bounds.
        keep: Keys that should not move.
        clipped: Ranges that lay outside of their bounds, in part or entirely.
        mended: Ranges upside down or without width, and captions that the encoder would misread.
        dropped: Fields and entries that were of no use.
        missing: Fields that the schema has and the answer has not.
    """

    objects: list[PromptObject] = field(default_factory=list)
    prompts: Prompts = field(default_factory=lambda: Prompts("", "", ""))
    targets: dict[str, str] = field(default_factory=dict)
    colors: dict[Region, Values] = field(default_factory=dict)
    ignored: list[str] = field(default_factory=list)
    entries: dict[str, PlanEntry] = field(default_factory=dict)
    keep: set[str] = field(default_factory=set)
    clipped: int = 0
    mended: int = 0
    dropped: int = 0
    missing: int = 0

    @property
    def useful(self) -> bool:
        """Whether there is anything in it to go by."""
        return bool(self.entries or self.targets or self.colors or self.prompts.whole or self.prompts.subject)


def read_reply(raw: dict[str, Any], table: AliasTable) -> Reply:
    """Checks an answer.

    Args:
        raw: The JSON object, whatever is in it.
    """
    reply = Reply()
    fields = ("objects", "prompts", "targets", "colors", "ignored", "plan", "keep")
    reply.missing = sum(name not in raw for name in fields)
    reply.dropped = len(set(raw) - set(fields))
    reply.objects = _objects(raw.get("objects"), table, reply)
    reply.prompts = _prompts(raw.get("prompts"), reply)
    reply.targets = _targets(raw.get("targets"), reply)
    reply.colors = _colors(raw.get("colors"), reply)
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


def _targets(raw: Any, reply: Reply) -> dict[str, str]:
    targets, known = {}, quantities().by_name
    for name, value in (raw if isinstance(raw, dict) else {}).items():
        if name in known and isinstance(value, str) and value in known[name].classes:
            targets[name] = value
        elif value not in ("", None):
            reply.dropped += 1
    return targets


def _colors(raw: Any, reply: Reply) -> dict[Region, Values]:
    colors: dict[Region, Values] = {}
    for region, value in (raw if isinstance(raw, dict) else {}).items():
        if region in REGIONS and isinstance(value, str) and is_hex(value.strip()):
            colors[region] = srgb_from_hex(value.strip())
        elif value not in ("", None):
            reply.dropped += 1
    return colors


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
    meant = clip(*table.meant(instance, *ordered), instance)
    wide = widened(instance, *meant)
    reply.mended += None in ends or ordered != (low, high) or wide != meant
    priority = item.get("priority")
    number = priority if isinstance(priority, int) and not isinstance(priority, bool) else 5
    reason = clean(item.get("reason"), _REASON) or "part of the look"
    reply.entries[instance.key] = PlanEntry(*wide, min(max(number, 1), _LAST), f"model: {reason}", prior=0.0)


def widened(instance: Instance, lower: Values, upper: Values) -> tuple[Values, Values]:
    """A range with at least the least width on the perceptual scale, inside the parameter's bounds.

    Args:
        instance: The parameter, with its bounds.
        lower: The lower end, one number per component, in the schema's units.

    Returns:
        Both ends; components that are wide enough stay as they are.
    """
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
