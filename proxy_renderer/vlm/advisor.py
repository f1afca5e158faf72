# SPDX-License-Identifier: Apache-2.0
"""The model as parser and confiner: it improves on the offline planner's draft, which stands in where it fails.

A model's answer is checked field by field: what is right is used, what is not is mended or dropped. Nothing of it is ever run,
opened or looked up: it is numbers, classes of ours, and short texts.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
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
from .request import CAPTIONS, REGIONS, AliasTable, make_question
from .transport import ModelError, clean

_MOST_TEXTS, _MOST_ENTRIES = 8, 200
_CAPTION, _WORD, _REASON = 160, 60, 160
_LAST = 99  # greatest priority
_NARROWEST = 0.04  # of the perceptual scale: a plan says where, the gradient where exactly
_DEGREES = 10.0  # likewise, of an angle
_NEGATION = re.compile(r"\b(no|not|never|without|n't)\b", re.IGNORECASE)


@dataclass
class Reply:
    """A model's proposals; fields are empty where its answer had nothing usable."""

    prompts: Prompts = field(default_factory=lambda: Prompts("", "", ""))  # captions; "" and () for none
    targets: dict[str, str] = field(default_factory=dict)  # quantity -> class
    colors: dict[Region, Values] = field(default_factory=dict)  # region -> sRGB that it should show
    ignored: list[str] = field(default_factory=list)  # words that no parameter can express
    entries: dict[str, PlanEntry] = field(default_factory=dict)  # key -> plan entry, within hard bounds
    keep: set[str] = field(default_factory=set)  # keys that should not move

    @property
    def useful(self) -> bool:
        """True if there is anything in it to go by."""
        return bool(self.entries or self.targets or self.colors or self.prompts.whole or self.prompts.subject)


def read_reply(raw: dict[str, Any], table: AliasTable) -> Reply:
    """Checks an answer."""
    classes = {name: quantity.classes for name, quantity in quantities().by_name.items()}
    colors = _usable(raw.get("colors"), lambda name, text: name in REGIONS and is_hex(text))
    entries: dict[str, PlanEntry] = {}
    for item in _list(raw.get("plan"))[:_MOST_ENTRIES]:
        if (made := _entry(item, table)) is not None:
            entries.setdefault(*made)
    kept = [n for n in _list(raw.get("keep"))[:_MOST_ENTRIES] if isinstance(n, str) and n in table.rows]
    return Reply(
        prompts=_prompts(raw.get("prompts")),
        targets=_usable(raw.get("targets"), lambda name, text: text in classes.get(name, ())),
        colors={region: srgb_from_hex(text) for region, text in colors.items()},  # type: ignore[misc]
        ignored=_texts(raw.get("ignored"), _WORD),
        entries=entries,
        keep={table.rows[name].key for name in kept} - set(entries),
    )


def _prompts(raw: Any) -> Prompts:
    """Captions; one with a negation is no use to an encoder, which reads past the "no"."""
    given = raw if isinstance(raw, dict) else {}

    def usable(name: str) -> tuple[str, ...]:
        value = given.get(name)
        captions = _texts(value if isinstance(value, list) else [value], _CAPTION)
        return tuple(t for t in captions if not _NEGATION.search(t))

    subject, surroundings, whole = ("".join(usable(name)[:1]) for name in CAPTIONS)
    return Prompts(subject, surroundings, whole, *(usable(f"{name}_negatives") for name in CAPTIONS))


def _usable(raw: Any, fits: Callable[[str, str], bool]) -> dict[str, str]:
    """The texts in an object that fit their names."""
    given = raw if isinstance(raw, dict) else {}
    texts = {name: value.strip() for name, value in given.items() if isinstance(value, str)}
    return {name: text for name, text in texts.items() if fits(name, text)}


def _entry(item: Any, table: AliasTable) -> tuple[str, PlanEntry] | None:
    """A parameter's key and its plan, in its own unit, within its bounds, and with some width; None where it is no plan."""
    name = item.get("parameter") if isinstance(item, dict) else None
    instance = table.rows.get(name) if isinstance(name, str) else None
    if instance is None:
        return None
    lower, upper = (_numbers(item.get(side), instance.parameter.components) for side in ("lower", "upper"))
    if lower is None or upper is None:
        return None
    least, most = table.bounds(instance)
    low, high = (tuple(min(max(v, least), most) for v in end) for end in (lower, upper))
    planned = clip(*table.in_schema_units(instance, *table.ordered(instance, low, high)), instance)
    priority = item.get("priority")
    number = priority if type(priority) is int else 5
    reason = clean(item.get("reason"), _REASON) or "part of the look"
    wide = widened(instance, *planned)
    return instance.key, PlanEntry(*wide, min(max(number, 1), _LAST), f"model: {reason}", prior=0.0)


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
    cleaned = (clean(t, longest) for t in _list(raw))
    return [t for t in dict.fromkeys(cleaned) if t][:_MOST_TEXTS]


def _list(raw: Any) -> list[Any]:
    return raw if isinstance(raw, list) else []


_MODEL = "the model"  # what stands in reports in the place of a word, where a model asks for something
_KEEPS = "model: keeps the artist's value"
_COLORS = {"subject": "color", "surroundings": "surroundings_color"}  # region -> quantity of its color
_PATIENCE = 2  # rounds in a row without an answer, after which the model is not asked any more


class ModelAdvisor:
    """Asks a model once a round, with the current picture; the draft is made of the goals and of what a rig plans."""

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
        self._last: Advice | None = (
            None  # with the model's help, which stands in where the vocabulary knows no word
        )
        self._failures: list[str] = []
        self._in_a_row = 0
        self._given_up = False

    def advise(self, display: Any, instances: Mapping[str, Instance], context: SceneDescription) -> Advice:
        """The model's advice, else the offline planner's; raises VibeError if neither understands. The first display may be None."""
        try:
            draft: Advice | None = self._offline.advise(display, instances, context)
            unknown: VibeError | None = None
        except VibeError as error:
            draft, unknown = None, error
        if self._given_up:
            return self._alone(draft, unknown, self._failures[-1])
        try:
            reply = self._ask(display, instances, context, draft)
        except ModelError as error:
            self._failures.append(str(error))
            self._in_a_row += 1
            self._given_up = error.lasting or self._in_a_row == _PATIENCE
            rest = "the rest is" if self._given_up else "this round is"
            self._tell(f"{error.message} So {rest} planned offline")
            return self._alone(draft, unknown, str(error))
        self._in_a_row = 0
        self._last = self._combine(draft, reply, instances, context)
        return self._last

    def account(self) -> dict[str, Any]:
        """For report.json: the model, its cost and its failures."""
        return {
            "model": self._client.endpoint.model,
            "endpoint": self._client.endpoint.place,
            "pictures": self._client.dialect.pictures,
            "format": self._client.dialect.format,
            **self._client.usage.account(),
            "failures": self._failures,
        }

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

        return read_reply(self._client.ask(question, check), table)

    def _combine(
        self, draft: Advice | None, reply: Reply, instances: Mapping[str, Instance], context: SceneDescription
    ) -> Advice:
        """The model's words where it has some, the draft's elsewhere; its ranges over the drafted ones."""
        read = draft.goals if draft else goals_of(self._read(reply.prompts.whole))
        parsed = read.parsed if draft else replace(read.parsed, ignored=reply.ignored)
        # The prompt's own words come first, the model's wishes are implied.
        goals = resolved(parsed, [*read.wishes, *(each.wish for each in read.lost), *_wishes(reply)])
        composed = compose(read.parsed, read.overruled)
        theirs = {name: value for name, value in vars(reply.prompts).items() if value}
        prompts = replace(composed, **theirs)
        # Its ranges replace the drafted ones; parameters that it keeps leave the plan.
        drafted = confine(goals, dict(instances), context)
        kept = {k: PlanEntry.kept(instances[k], _KEEPS) for k in drafted if k in reply.keep}
        plan = Plan({**drafted, **kept, **reply.entries}, drafted.notes)
        unmeasured = draft.unmeasured if draft else prompts
        return Advice(goals, prompts, plan, unmeasured, self._client.endpoint.model)

    def _alone(self, draft: Advice | None, unknown: VibeError | None, why: str) -> Advice:
        """The advice without the model: the draft, or the last one that the model helped with."""
        advice = draft or self._last
        if advice is None:
            assert unknown is not None
            problem = f"{unknown.message} And the model did not help: {why}"
            raise VibeError(problem, unknown.remedy) from unknown
        return replace(advice, source=f"offline planner: {why}")

    def _read(self, caption: str) -> Parsed:
        try:
            return replace(parse(caption, self._words), prompt=self._prompt)
        except VibeError:
            return Parsed(self._prompt, objects=[PromptObject("subject", "subject")])


def _wishes(reply: Reply) -> Iterator[Wish]:
    for quantity, named in reply.targets.items():
        word = Attribute(named, "", "mood", "whole", "light", cause=_MODEL)
        yield Wish(word, quantity, named, claims=quantities().by_name[quantity].classes[named])
    for region, color in reply.colors.items():
        word = Attribute(hex_from_srgb(color), "", "color", region, region, color=color, cause=_MODEL)
        yield Wish(word, _COLORS[region])
