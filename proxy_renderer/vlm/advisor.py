# SPDX-License-Identifier: Apache-2.0
"""The model as parser and confiner: it improves on the offline planner's draft, which stands in where it fails."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from ..color.floats import hex_from_srgb
from ..goals.resolve import Goals, goals_of, resolved
from ..goals.wish import Wish
from ..planning.advice import Advice, OfflineAdvisor, Prompts, compose
from ..planning.planner import plan as confine
from ..planning.types import LightPlan, Plan, PlanEntry
from ..schema import Instance, VibeError
from ..words.lexicon.quantities import quantities
from ..words.parser import Understood, parse
from ..words.types import Attribute, Parsed, PromptObject, SceneDescription
from .client import Client, jpeg_of
from .reply import Reply, read_reply
from .request import AliasTable, make_question
from .transport import ModelError

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
        self._caption = ""  # the model's own words for the look: the vocabulary may know these at least
        self._failures: list[str] = []
        self._in_a_row = 0
        self._given_up = False
        self._counts = {"clipped": 0, "mended": 0, "dropped": 0, "missing": 0}

    def advise(self, display: Any, instances: Mapping[str, Instance], context: SceneDescription) -> Advice:
        """The model's advice, else the offline planner's; raises VibeError if neither understands. The first display may be None."""
        try:
            draft: Advice | None = self._offline.advise(display, instances, context)
            unknown: VibeError | None = None
        except VibeError as error:
            draft, unknown = None, error
        if self._given_up:
            return self._alone(draft, unknown, instances, context, self._failures[-1])
        try:
            reply = self._ask(display, instances, context, draft)
        except ModelError as error:
            self._failures.append(str(error))
            self._in_a_row += 1
            self._given_up = error.lasting or self._in_a_row == _PATIENCE
            rest = "the rest is" if self._given_up else "this round is"
            self._tell(f"{error.message} So {rest} planned offline")
            return self._alone(draft, unknown, instances, context, str(error))
        self._in_a_row = 0
        self._caption = reply.prompts.whole or self._caption
        return self._combine(draft, reply, instances, context)

    def account(self) -> dict[str, Any]:
        """For report.json: the model, its cost, its failures, and the parts of its answers that were not used."""
        return {
            "model": self._client.endpoint.model,
            "endpoint": self._client.endpoint.place,
            "pictures": self._client.dialect.pictures,
            "format": self._client.dialect.format,
            **self._client.usage.account(),
            "failures": self._failures,
            **self._counts,
        }

    def _ask(
        self, display: Any, instances: Mapping[str, Instance], context: SceneDescription, draft: Advice | None
    ) -> Reply:
        table = AliasTable(instances, context)
        empty = Advice(Goals(Parsed(self._prompt)), Prompts("", "", ""), Plan())
        base = draft or empty
        question = make_question(
            self._prompt, table, context, (base.goals, base.prompts, base.plan), jpeg_of(display)
        )
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
        """The model's words where it has some, the draft's elsewhere; its ranges over the drafted ones."""
        read = draft.goals if draft else goals_of(self._read(reply.prompts.whole))
        parsed = replace(
            read.parsed,
            objects=reply.objects
            or read.parsed.objects
            or [PromptObject(self._words.subject or "subject", "subject")],
            ignored=reply.ignored if draft is None else read.parsed.ignored,
        )
        # The prompt's own words come first, the model's wishes are implied.
        goals = resolved(parsed, [*read.wishes, *(each.wish for each in read.lost), *_wishes(reply)])
        composed = compose(read.parsed, read.overruled)
        theirs = {name: value for name, value in vars(reply.prompts).items() if value}
        prompts = replace(composed, **theirs)
        # Its ranges replace the drafted ones; parameters that it keeps leave the plan.
        drafted = confine(goals, dict(instances), context)
        entries = {
            k: PlanEntry.kept(instances[k], _KEEPS) if k in reply.keep else e for k, e in drafted.items()
        }
        plan = Plan({**entries, **reply.entries}, drafted.notes)
        return Advice(
            goals, prompts, plan, draft.unmeasured if draft else prompts, self._client.endpoint.model
        )

    def _alone(
        self,
        draft: Advice | None,
        unknown: VibeError | None,
        instances: Mapping[str, Instance],
        context: SceneDescription,
        why: str,
    ) -> Advice:
        """The advice without the model: the draft, or the model's earlier caption as the vocabulary reads it."""
        if draft is None and self._caption:
            parsed = self._read(self._caption)
            if parsed.attributes:
                goals = goals_of(parsed)
                prompts = compose(parsed, goals.overruled)
                draft = Advice(goals, prompts, confine(goals, dict(instances), context))
        if draft is None:
            assert unknown is not None
            remedy = unknown.remedy
            raise VibeError(f"{unknown.message} And the model did not help: {why}", remedy) from unknown
        return replace(draft, source=f"offline planner: {why}")

    def _read(self, caption: str) -> Parsed:
        """The model's caption, parsed with the vocabulary."""
        try:
            return replace(parse(caption, self._words), prompt=self._prompt)
        except VibeError:
            return Parsed(self._prompt, objects=[PromptObject("subject", "subject")])


def _wishes(reply: Reply) -> Iterator[Wish]:
    """A model's wishes for the image: implied, so that the prompt's own words come first."""
    for quantity, named in reply.targets.items():
        word = Attribute(named, "", "mood", "whole", "light", cause=_MODEL)
        yield Wish(word, quantity, named, claims=quantities().by_name[quantity].classes[named])
    for region, color in reply.colors.items():
        word = Attribute(hex_from_srgb(color), "", "color", region, region, color=color, cause=_MODEL)
        yield Wish(word, _COLORS[region])
