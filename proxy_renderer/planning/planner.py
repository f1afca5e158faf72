# SPDX-License-Identifier: Apache-2.0
"""The confiner without a model: for every parameter a range, a priority and a reason (paper, section 3.6)."""

from __future__ import annotations

import math
from dataclasses import replace

from ..color.floats import srgb_from_linear
from ..prompt.heads import is_vague
from ..prompt.lexicon.entries import Effect
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.types import Attribute, Parsed, Prompts
from ..schema import Instance, Values, labels
from .color_ranges import named_color, painted
from .demands import Demand, lacking, reason_of
from .lights.facing import facing_radiance
from .owners import BACKDROP, SEEN, Owners
from .ranges import clip, effect_range, within
from .sources import Range, Sources, WorldLook
from .support import added_power, supports
from .types import Plan, PlanContext, PlanEntry
from .wishes import STAGES, Wishes, is_usual, stage_of

_NOT = 0.6  # "not glossy" asks for a mild "matte"
_OF_SHADOWS = ("size", "angle")
"""Parameters that begin well inside of their ranges: edges of shadows have slopes that say little of where hardness is found."""
_WELL_INSIDE = 0.75
"""Where, from the end that is nearer to the artist's value: the sun's shadows are hard, not just harder."""
_RELATIVE = ("shade", "times", "plus", "lightness")
"""Modes of effects on what a thing has, or what its material gives it: fresh asphalt is a smoother dark gray."""
_SECOND = 6  # how much later a mood's own words come than the prompt's


def plan(
    parsed: Parsed,
    prompts: Prompts,
    instances: dict[str, Instance],
    context: PlanContext,
    vocabulary: Vocabulary | None = None,
) -> Plan:
    """Decides what may happen to every parameter of a scene.

    What words name gets a range (projection moves the value inside) and a priority; a few others
    may move a little to keep the subject visible; the rest keeps the artist's value.
    """
    planner = _Planner(parsed, instances, context, vocabulary or default_vocabulary())
    entries = planner.entries()
    for key, entry in supports(parsed, instances, planner.sources, entries, planner.owners).items():
        entries[key] = entry
    return Plan({key: entries[key] for key in instances}, tuple(dict.fromkeys(planner.notes)))


class _Planner:
    def __init__(
        self, parsed: Parsed, instances: dict[str, Instance], context: PlanContext, vocabulary: Vocabulary
    ) -> None:
        self.parsed, self.instances, self.vocabulary = parsed, instances, vocabulary
        self.owners = Owners(parsed, instances, context, vocabulary)
        self.wishes = Wishes(parsed, vocabulary, self.owners)
        stops = [i.value[0] for i in instances.values() if i.parameter.name in ("exposure", "grade_exposure")]
        self.sources = Sources(context, exposure=sum(stops))
        self.notes = list(parsed.conflicts)
        self.demands: dict[str, list[Demand]] = {}
        self.settled: dict[str, tuple[Range, list[Demand]]] = {}
        self.beaten: dict[tuple[str, str], dict[str, None]] = {}
        self.kept: dict[str, list[str]] = {}
        self.matter: dict[str, Values] = {}

    def entries(self) -> dict[str, PlanEntry]:
        """An entry for every instance, from the words alone."""
        wishes = self.wishes.all()
        self.matter = self._matter(wishes)
        for stage in range(STAGES):
            self._settle([d for a, e in wishes if stage_of(e) == stage for d in self._demands(a, e)])
            self._note_sources()
        entries = {key: self._entry(instance) for key, instance in self.instances.items()}
        for (loser, winner), lost in self.beaten.items():
            self.notes.append(
                f"'{loser}' gives way to '{winner}' on {labels.titles(list(lost))}: "
                "they contradict each other; what a word is mainly about counts most, then what comes first."
            )
        self.notes += self._unmet(wishes)
        for reason, keys in self.kept.items():
            self.notes.append(f"Left alone, though the words ask for it: {labels.titles(keys)} ({reason}).")
        return entries

    def _matter(self, wishes: list[tuple[Attribute, Effect]]) -> dict[str, Values]:
        """The values that things have by the material that words name."""
        found = {}
        for attribute, effect in wishes:
            if attribute.slot == "material" and effect.mode in ("", "color"):
                for instance in self.owners.of(effect, attribute):
                    found[instance.key] = (
                        painted(effect, attribute, instance, self.sources)
                        if effect.color
                        else within(instance.value, *effect_range(effect, attribute, instance, self.sources))
                    )
        return found

    def _unmet(self, wishes: list[tuple[Attribute, Effect]]) -> list[str]:
        """Words whose main wish no part of the scene can fulfill: a rim light where there is only one light."""
        missing: dict[str, str] = {}
        for attribute in self.parsed.attributes:
            strong = [e for a, e in wishes if a == attribute and not e.weak]
            most = min((e.priority for e in strong), default=0)
            main = [e for e in strong if e.priority == most]
            if main and not any(self.owners.of(e, attribute) for e in main):
                missing.setdefault(attribute.cause or attribute.word, lacking(main[0].owner))
        return [f"'{word}' is not fully possible here: {what}." for word, what in missing.items()]

    def _demands(self, attribute: Attribute, effect: Effect) -> list[Demand]:
        shown = self.vocabulary.entries.get(attribute.entry)
        strength = attribute.strength
        if attribute.negated and shown and not shown.never and shown.opposite:
            strength = _NOT
        demands = []
        for instance in self.owners.of(effect, attribute):
            added = instance.owner in self.sources.context.added_lights
            if added and effect.mode == "times" and effect.name == "power":
                if effect.lower[0] >= 1.0:  # words ask for it: it has nothing to be stronger than
                    continue
                instance = replace(instance, value=added_power(instance, self.sources))
            if effect.mode in _RELATIVE and instance.key in self.matter:
                instance = replace(instance, value=self.matter[instance.key])
            sources = replace(self.sources, own_color=self._own_color(instance.owner))
            vague, usual = is_vague(attribute, self.vocabulary), is_usual(attribute, effect)
            if instance.parameter.name.startswith("backdrop"):
                sources = replace(sources, world=self.sources.backdrop)
                vague = vague or attribute.kind not in SEEN  # words for what is seen come first there
            lower, upper = effect_range(effect, replace(attribute, strength=strength), instance, sources)
            if (
                effect.family == "material/emission"
                and not effect.mode
                and effect.lower[0] > 0
                and strength >= 1
            ):
                # What glows more than words like "glowing" ask for does not get darker by them.
                upper = max(upper, instance.value) if self._glow(instance.owner) > lower[0] else upper
            priority = effect.priority + (2 if effect.weak else 0) + (_SECOND if attribute.cause else 0)
            light = f"material/{instance.owner}" if instance.parameter.group == "material" else instance.owner
            priority += 2 * (effect.owner == "lights" and light not in self.owners.lights.key)
            # A color that is named comes before a word that only changes it: "a teal ball, the ball darker".
            priority += effect.mode == "times" and instance.parameter.kind == "color"
            reason = reason_of(attribute, shown.phrase if shown else "")
            start = named_color(effect, attribute, instance, sources) if effect.color else None
            rank = effect.weak, priority, vague, usual
            wide = effect.mode == "cast"  # from faint to strong: no box whose corners are other hues
            demands.append(Demand(instance.key, lower, upper, attribute, reason, *rank, start, wide))
        return demands

    def _settle(self, demands: list[Demand]) -> None:
        """Intersects what the words want; where they contradict each other, the first one has its way."""
        for demand in demands:
            self.demands.setdefault(demand.key, []).append(demand)
        for key in dict.fromkeys(d.key for d in demands):  # a set would be in another order each time
            first, *others = sorted(self.demands[key], key=lambda d: d.rank)
            lower, upper, winners = first.lower, first.upper, [first]
            for demand in others:
                if demand.usual and not first.usual:
                    continue
                low, high = tuple(map(max, lower, demand.lower)), tuple(map(min, upper, demand.upper))
                agrees = all(a <= b for a, b in zip(low, high, strict=True))
                if agrees and not first.start:  # what is left of a named color's room would be another color
                    lower, upper, winners = low, high, [*winners, demand]
                elif (
                    (demand.start or not agrees)
                    and not any(demand.rank[:3] + first.rank[:3])
                    and demand.reason != first.reason
                ):
                    pair = demand.attribute.word, first.attribute.word
                    self.beaten.setdefault(pair, {})[key] = None
            self.settled[key] = (lower, upper), winners

    def _note_sources(self) -> None:
        context, key = self.sources.context, self.owners.lights.key
        facing = facing_radiance(self.instances, context, self._planned, key)
        self.sources = replace(self.sources, key=facing)
        world = backdrop = self._world("", context.environment_luminance)
        if BACKDROP in self.instances:
            backdrop = self._world("backdrop_", context.backdrop_luminance)
        self.sources = replace(self.sources, world=world, backdrop=backdrop)

    def _world(self, part: str, level: float) -> WorldLook:
        """What is settled of the world, or of its backdrop, whose picture has a mean luminance."""
        color, tint = (self.instances.get(f"world/{part}{name}") for name in ("color", "tint"))
        if color:
            return WorldLook(self._planned(color))
        return WorldLook(tuple(v * level for v in self._planned(tint)), level) if tint else WorldLook()

    def _planned(self, instance: Instance) -> Values:
        """The artist's value, projected into what is settled so far."""
        if instance.key not in self.settled:
            return instance.value
        (lower, upper), winners = self.settled[instance.key]
        return within(winners[0].start or instance.value, lower, upper)

    def _own_color(self, owner: str) -> tuple[float, ...]:
        """The color that a material gets, or has."""
        named = [a for a in self.parsed.attributes if a.kind == "subject" and a.color and not a.negated]
        if named and named[0].color:
            return named[0].color
        found = (self.instances.get(f"material/{owner}/{name}") for name in ("base_color", "tint"))
        return next((srgb_from_linear(self._planned(i)) for i in found if i), (1.0, 1.0, 1.0))

    def _glows(self, owner: str) -> bool:
        """Whether a material is to glow, or does: many have a strength of 1 and a black emission color."""
        key = f"material/{owner}/emission"
        asked = self.settled[key][0][1][0] if key in self.settled else 0.0
        return max(asked, self._glow(owner)) > 0.02

    def _glow(self, owner: str) -> float:
        """How strongly a material glows as the artist has it, in the unit of its emission."""
        strength, color = (
            self.instances.get(f"material/{owner}/{n}") for n in ("emission", "emission_color")
        )
        return strength.value[0] * max(color.value) if strength and color else 0.0

    def _entry(self, instance: Instance) -> PlanEntry:
        settled = self.settled.get(instance.key)
        if instance.locked:
            if settled:
                self.kept.setdefault(instance.locked, []).append(instance.key)
            return PlanEntry(instance.value, instance.value, None, f"locked: {instance.locked}")
        if not settled:
            return PlanEntry(
                instance.lower, instance.upper, None, "no word touches it: keeps the artist's value"
            )
        (lower, upper), winners = settled
        if instance.parameter.family == "material/emission_color" and not self._glows(instance.owner):
            return PlanEntry(instance.lower, instance.upper, None, "does not glow: keeps the artist's value")
        lower, upper = clip(lower, upper, instance)
        reason = "; ".join(dict.fromkeys(d.reason for d in winners))
        usual = all(d.weak for d in winners)
        start = winners[0].start and within(winners[0].start, lower, upper)
        moved = not math.isclose(instance.value[0], within(instance.value, lower, upper)[0], rel_tol=1e-6)
        if instance.parameter.name in _OF_SHADOWS and moved:
            near, far = (lower, upper) if instance.value < lower else (upper, lower)
            start = (near[0] ** (1 - _WELL_INSIDE) * far[0] ** _WELL_INSIDE,)
        priority = min(d.priority for d in winners)
        any_hue = winners[0].any_hue
        return PlanEntry(lower, upper, priority, reason, prior=0.0, usual=usual, any_hue=any_hue, start=start)
