# SPDX-License-Identifier: Apache-2.0
"""The model as parser (words) and confiner (ranges): it improves the offline draft, which is used if it fails.

A model's answer is checked field by field. Valid fields are used; others are repaired or dropped, and counted. Nothing in an
answer is run, opened or looked up: it has only numbers, known classes and short texts.
"""

import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ..color.floats import hex_from_srgb, is_hex, srgb_from_hex
from ..goals.resolve import Goals, goals_of, resolved
from ..goals.wish import Wish
from ..planning.advice import Advice, OfflineAdvisor, Prompts, compose
from ..planning.planner import plan as confine
from ..planning.ranges import clip
from ..planning.types import LightPlan, Plan, PlanEntry
from ..schema import Instance, Values, VibeError
from ..schema.parameters import Region
from ..words.lexicon.quantities import quantities
from ..words.parser import Understood, parse
from ..words.types import Attribute, Parsed, PromptObject, SceneDescription
from .client import Client, jpeg_of
from .request import CAPTIONS, REGIONS, SLOTS, AliasTable, make_question
from .transport import ModelError, clean

_MOST_OBJECTS, _MOST_TEXTS, _MOST_ENTRIES = 12, 8, 200
_CAPTION, _WORD, _REASON = 160, 60, 160
_NARROWEST = 0.04  # least width of a range on the perceptual scale: the gradient finds the exact value
_DEGREES = 10.0  # least width of an angle's range, where this is narrower than `_NARROWEST`
_NEGATION = re.compile(r"\b(no|not|never|without|n't)\b", re.IGNORECASE)


@dataclass
class Reply:
    """A model's proposals; fields are empty where its answer had nothing usable."""

    objects: list[PromptObject] = field(default_factory=list)  # the objects that the look describes
    prompts: Prompts = field(default_factory=lambda: Prompts("", "", ""))  # captions; "" and () for none
    targets: dict[str, str] = field(default_factory=dict)  # quantity -> class
    colors: dict[Region, Values] = field(default_factory=dict)  # region -> sRGB that it should show
    ignored: list[str] = field(default_factory=list)  # words that no parameter can express
    entries: dict[str, PlanEntry] = field(default_factory=dict)  # key -> plan entry, within hard bounds
    keep: set[str] = field(default_factory=set)  # keys that should not move
    clipped: int = 0  # ranges that lay outside of their bounds, in part or entirely
    mended: int = 0  # reversed, one-sided or too narrow ranges, and captions with a negation
    dropped: int = 0  # fields and entries that could not be used
    missing: int = 0  # fields of the schema that the answer lacks

    @property
    def useful(self) -> bool:
        """True if the reply has anything that can change the plan or the captions."""
        return bool(self.entries or self.targets or self.colors or self.prompts.whole or self.prompts.subject)


def read_reply(raw: dict[str, Any], table: AliasTable) -> Reply:
    """The usable parts of a model's answer `raw`, a JSON object, with counts of the others."""
    fields = {"objects", "prompts", "targets", "colors", "ignored", "plan", "keep"}
    reply = Reply(missing=len(fields - raw.keys()), dropped=len(raw.keys() - fields))
    reply.objects = _objects(raw.get("objects"), table, reply)
    reply.prompts = _prompts(raw.get("prompts"), reply)
    classes = {name: quantity.classes for name, quantity in quantities().by_name.items()}
    reply.targets = _usable(raw.get("targets"), lambda name, text: text in classes.get(name, ()), reply)
    colors = _usable(raw.get("colors"), lambda name, text: name in REGIONS and is_hex(text), reply)
    reply.colors = {region: srgb_from_hex(text) for region, text in colors.items()}  # type: ignore[misc]
    reply.ignored = _texts(raw.get("ignored"), _WORD)
    for item in _list(raw.get("plan"), reply)[:_MOST_ENTRIES]:
        _add_entry(item, table, reply)
    kept = _list(raw.get("keep"), reply)[:_MOST_ENTRIES]
    known = [table.rows[name].key for name in kept if isinstance(name, str) and name in table.rows]
    reply.dropped += len(kept) - len(known)
    reply.keep = set(known) - set(reply.entries)
    return reply


def _objects(raw: Any, table: AliasTable, reply: Reply) -> list[PromptObject]:
    objects = []
    names = {alias.id: alias.name for alias in table.aliases}
    for item in _list(raw, reply)[:_MOST_OBJECTS]:
        region = item.get("region") if isinstance(item, dict) else None
        if region not in REGIONS:
            reply.dropped += 1
            continue
        given, worn = item.get("attributes"), item.get("materials")
        given = given if isinstance(given, dict) else {}
        attributes = {slot: words for slot in SLOTS if (words := clean(given.get(slot), _CAPTION))}
        worn = worn if isinstance(worn, list) else []
        owners = tuple(names[m] for m in worn if isinstance(m, str) and m in names)
        objects.append(PromptObject(clean(item.get("name"), _WORD) or region, region, attributes, owners))
    return objects


def _prompts(raw: Any, reply: Reply) -> Prompts:
    """The captions; without those that have a negation, because the encoder ignores the "no"."""
    given = raw if isinstance(raw, dict) else {}

    def usable(name: str) -> tuple[str, ...]:
        value = given.get(name)
        captions = _texts(value if isinstance(value, list) else [value], _CAPTION)
        fine = tuple(t for t in captions if not _NEGATION.search(t))
        reply.mended += len(captions) - len(fine)
        return fine

    subject, surroundings, whole = ("".join(usable(name)[:1]) for name in CAPTIONS)
    return Prompts(subject, surroundings, whole, *(usable(f"{name}_negatives") for name in CAPTIONS))


def _usable(raw: Any, fits: Callable[[str, str], bool], reply: Reply) -> dict[str, str]:
    """The texts in a JSON object that `fits` accepts, by name; all others, unless empty, are counted as dropped."""
    found = {}
    for name, value in (raw if isinstance(raw, dict) else {}).items():
        if isinstance(value, str) and fits(name, value.strip()):
            found[name] = value.strip()
        elif value not in ("", None):
            reply.dropped += 1
    return found


def _add_entry(item: Any, table: AliasTable, reply: Reply) -> None:
    """Adds `item` of an answer's plan to the reply: in the parameter's own unit, within its bounds, not too narrow.

    An unusable item is counted as dropped.
    """
    name = item.get("parameter") if isinstance(item, dict) else None
    instance = table.rows.get(name) if isinstance(name, str) else None
    if instance is None or instance.key in reply.entries:
        reply.dropped += 1
        return
    ends = [_numbers(item.get(side), instance.parameter.components) for side in ("lower", "upper")]
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
    reply.entries[instance.key] = PlanEntry(*wide, min(max(number, 1), 99), f"model: {reason}", prior=0.0)


def widened(instance: Instance, lower: Values, upper: Values) -> tuple[Values, Values]:
    """A range, widened if necessary to the least width on the perceptual scale, inside the parameter's bounds."""
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
    """`count` floats, from a list of as many finite numbers or from one number for all; None for anything else."""
    given = raw if isinstance(raw, list) else [raw]
    given = given * count if len(given) == 1 else given
    # type(), because True is an int, too; the comparison is False for NaN, and works for integers of any size.
    fine = all(type(v) in (int, float) and abs(v) <= sys.float_info.max for v in given)
    return tuple(map(float, given)) if fine and len(given) == count else None


def _texts(raw: Any, longest: int) -> list[str]:
    cleaned = (clean(t, longest) for t in (raw if isinstance(raw, list) else []))
    return [t for t in dict.fromkeys(cleaned) if t][:_MOST_TEXTS]


def _list(raw: Any, reply: Reply) -> list[Any]:
    if isinstance(raw, list):
        return raw
    reply.dropped += raw is not None
    return []


_MODEL = "the model"  # takes the place of the word in reports on the model's wishes
_PATIENCE = 2  # rounds in a row without an answer, after which the model is not asked any more


class ModelAdvisor:
    """Asks a model once a round, with the current image, to improve the offline planner's draft.

    `tell` shows a line of progress; `light` is the plan of the lighting rig, None without one.
    """

    def __init__(
        self,
        understood: Understood,
        goals: Goals | VibeError,
        client: Client,
        tell: Callable[[str], None],
        light: LightPlan | None = None,
    ) -> None:
        self._prompt, self._words = understood.prompt, understood.scene
        self._client, self._tell = client, tell
        self._offline = OfflineAdvisor(goals, light)
        self._caption = ""  # the model's last caption of the look, whose words the vocabulary may know
        self._failures: list[str] = []
        self._in_a_row = 0  # failures without a success in between
        self._counts = dict.fromkeys(("clipped", "mended", "dropped", "missing"), 0)

    def advise(self, display: Any, instances: Mapping[str, Instance], context: SceneDescription) -> Advice:
        """The model's advice, else the planner's; VibeError if neither understands. `display`: image (H, W, 3)."""
        try:
            draft: Advice | None = self._offline.advise(display, instances, context)
            unknown: VibeError | None = None
        except VibeError as error:
            draft, unknown = None, error
        if self._in_a_row < _PATIENCE:
            try:
                reply = self._ask(display, instances, context, draft)
                self._in_a_row, self._caption = 0, reply.prompts.whole or self._caption
                return self._combine(draft, reply, instances, context)
            except ModelError as error:
                self._failures.append(str(error))
                self._in_a_row = _PATIENCE if error.lasting else self._in_a_row + 1
                rest = "this round is" if self._in_a_row < _PATIENCE else "the rest is"
                self._tell(f"{error.message} So {rest} planned offline")
        # Without the model: the draft, or the model's earlier caption as the vocabulary reads it
        why = self._failures[-1]
        if unknown is not None:
            parsed = self._read(self._caption)
            if not parsed.attributes:
                raise VibeError(f"{unknown.message} And the model did not help: {why}", unknown.remedy) from unknown
            goals = goals_of(parsed)
            draft = Advice(goals, compose(parsed, goals.overruled), confine(goals, dict(instances), context))
        assert draft is not None
        return replace(draft, source=f"offline planner: {why}")

    def account(self) -> dict[str, Any]:
        """Fields for report.json: the model, its cost, its failures, and counts of parts of answers not used."""
        model, dialect = self._client.endpoint, self._client.dialect
        asked = {"model": model.model, "endpoint": model.place, "pictures": dialect.pictures, "format": dialect.format}
        return {**asked, **self._client.usage.account(), "failures": self._failures, **self._counts}

    def _ask(
        self, display: Any, instances: Mapping[str, Instance], context: SceneDescription, draft: Advice | None
    ) -> Reply:
        table = AliasTable(instances, context)
        empty = Advice(Goals(Parsed(self._prompt)), Prompts("", "", ""), Plan())
        question = make_question(self._prompt, table, context, draft or empty, jpeg_of(display))
        self._tell(f"asking {self._client.endpoint.model}")

        def check(raw: Any) -> None:
            if not read_reply(raw, table).useful:
                raise ModelError("The model's answer has nothing in it to go by.", "Use a larger model.")

        reply = read_reply(self._client.ask(question, check), table)
        for name in self._counts:
            self._counts[name] += getattr(reply, name)
        return reply

    def _combine(
        self, draft: Advice | None, reply: Reply, instances: Mapping[str, Instance], context: SceneDescription
    ) -> Advice:
        """The draft with the reply's wishes added; captions and ranges in the reply replace the drafted ones."""
        read = draft.goals if draft else goals_of(self._read(reply.prompts.whole))
        subject = [PromptObject(self._words.subject or "subject", "subject")]
        objects = reply.objects or read.parsed.objects or subject
        ignored = reply.ignored if draft is None else read.parsed.ignored
        parsed = replace(read.parsed, objects=objects, ignored=ignored)
        # The prompt's own words come first, the model's wishes are implied.
        wishes = [*read.wishes, *(each.wish for each in read.lost)]
        for quantity, named in reply.targets.items():
            word = Attribute(named, "", "mood", "whole", "light", cause=_MODEL)
            wishes.append(Wish(word, quantity, named, claims=quantities().by_name[quantity].classes[named]))
        for region, color in reply.colors.items():
            word = Attribute(hex_from_srgb(color), "", "color", region, region, color=color, cause=_MODEL)
            wishes.append(Wish(word, "color" if region == "subject" else "surroundings_color"))
        goals = resolved(parsed, wishes)
        theirs = {name: value for name, value in vars(reply.prompts).items() if value}
        prompts = replace(compose(read.parsed, read.overruled), **theirs)
        # The model's ranges replace the drafted ones; parameters that it keeps leave the plan.
        drafted = confine(goals, dict(instances), context)
        why = "model: keeps the artist's value"
        kept = {key: PlanEntry.kept(instances[key], why) for key in drafted if key in reply.keep}
        plan = Plan({**drafted, **kept, **reply.entries}, drafted.notes)
        unmeasured = draft.unmeasured if draft else prompts
        return Advice(goals, prompts, plan, unmeasured, self._client.endpoint.model)

    def _read(self, caption: str) -> Parsed:
        try:
            return replace(parse(caption, self._words), prompt=self._prompt)
        except VibeError:
            return Parsed(self._prompt, objects=[PromptObject("subject", "subject")])
