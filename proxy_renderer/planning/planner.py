# SPDX-License-Identifier: Apache-2.0
"""The planner (the paper's confiner): from wishes to ranges, starts and priorities of a scene's parameters."""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from ..color.floats import srgb_from_linear
from ..goals.resolve import Goals
from ..goals.wish import Wish
from ..schema import Instance, Values, labels
from ..words.lexicon.entries import OWNERS, Effect
from ..words.lexicon.vocabulary import default_vocabulary
from ..words.types import GLOW, Attribute, SceneDescription
from .acting import STAGES, acts, goals_without_rig, grade_of, is_usual, stage_of
from .light_levels import Sources, WorldLook, facing_radiance
from .owners import BACKDROP, Owners, protected
from .picture_ranges import plan_with_picture
from .ranges import clip, effect_range, named_color, painted, within
from .support import added_power, supports
from .types import LEFT_ALONE, LightPlan, Plan, PlanEntry


@dataclass(frozen=True)
class WishedRange:
    """The range of one parameter's values that a wish asks for."""

    key: str  # of the parameter
    lower: Values
    upper: Values
    wish: Wish
    reason: str  # for the artist; quotes the word
    weak: bool  # whether it is a default, which is overridden without a note
    priority: int  # as in `PlanEntry`
    usual: bool = False  # whether a place usually has it: it counts only if no other word sets the parameter
    start: Values | None = None  # as in `PlanEntry`
    any_hue: bool = False  # as in `PlanEntry`

    @property
    def rank(self) -> tuple[bool | int, ...]:
        """The sort key of a conflict over one parameter: parts of `Wish.rank`, and the priority. The smallest wins."""
        _, _, usual, implied, general, paint, vague, _, _ = self.wish.rank
        return self.weak, usual, implied, paint, self.priority, general, vague

    @property
    def is_plain(self) -> bool:
        """True if the prompt itself asks for the range, which is neither a default nor implied nor usual."""
        return not (self.weak or self.wish.implied or self.wish.usual)


@dataclass(frozen=True)
class Agreement:
    """The range on which the winners of a conflict over one parameter agree; these winners, the first in rank first."""

    lower: Values
    upper: Values
    winners: list[WishedRange]


class Agreements:
    """Resolves conflicts of wishes over parameters; `of` maps a parameter's key to the range that remains."""

    def __init__(self) -> None:
        self.of: dict[str, Agreement] = {}
        self._ranges: dict[str, list[WishedRange]] = {}
        self._lost: dict[tuple[str, str], dict[str, None]] = {}

    def add(self, ranges: Iterable[WishedRange]) -> None:
        """Adds ranges, and resolves the conflicts over their parameters again."""
        keys: dict[str, None] = {}  # a set would have another order in each process
        for each in ranges:
            self._ranges.setdefault(each.key, []).append(each)
            keys[each.key] = None
        for key in keys:
            # the range of highest rank, narrowed by each further one that overlaps with what remains
            first, *others = sorted(self._ranges[key], key=lambda r: r.rank)
            lower, upper, winners = first.lower, first.upper, [first]
            for each in others:
                if each.usual and not first.usual:
                    continue
                low, high = tuple(map(max, lower, each.lower)), tuple(map(min, upper, each.upper))
                agrees = all(a <= b for a, b in zip(low, high, strict=True))
                both_plain = first.is_plain and each.is_plain
                if agrees and not first.start:  # a named color's range is not narrowed: that would change its hue
                    lower, upper, winners = low, high, [*winners, each]
                elif both_plain and each.reason != first.reason and (each.start or not agrees):
                    pair = each.wish.attribute.word, first.wish.attribute.word
                    self._lost.setdefault(pair, {})[each.key] = None
            self.of[key] = Agreement(lower, upper, winners)

    def value(self, instance: Instance) -> Values:
        """The artist's value, or a start that words name, moved into the range that remains so far, if there is one."""
        found = self.of.get(instance.key)
        return within(found.winners[0].start or instance.value, found.lower, found.upper) if found else instance.value

    def notes(self) -> Iterator[str]:
        """Sentences on words that are overridden by others, with the parameters that both need."""
        for (loser, winner), keys in self._lost.items():
            yield f"'{loser}' gives way to '{winner}' on {labels.titles(list(keys))}: both need it."


def reason_of(attribute: Attribute, phrase: str) -> str:
    """The reason of a range, which quotes the word: "'shiny' (glossy, with bright reflections)", "'cosy' means 'warm'"."""
    if attribute.cause:
        return f"'{attribute.cause}' means '{attribute.word}'"
    what = f" on the {attribute.thing}" if attribute.color and attribute.thing else ""
    plain = phrase and phrase != attribute.word and not (attribute.negated or attribute.shades)
    return f"'{attribute.word}'{what}" + (f" ({phrase})" if plain else "")


_FOG = "volume/density"
_GRADES = {
    "film/contrast": (0.8, 1.3), "film/saturation": (0.0, 1.45), "film/vignette": (0.0, 0.5),
    "film/lift": (0.94, 1.06), "film/midtone": (0.85, 1.15), "film/gain": (0.8, 1.2),
}  # fmt: skip
"""Limits of the grade next to a rig, whose light already makes most of the look."""


def plan(goals: Goals, instances: dict[str, Instance], scene: SceneDescription, light: LightPlan | None = None) -> Plan:
    """The plan of a scene: for each of its parameters, given by key, how far the search may move it, and why.

    A parameter that words name gets a range, into which its value is moved, and a priority. A few others may move a little to
    keep the subject visible. The rest keeps the artist's value.
    """
    light = light or LightPlan()
    planner = _Planner(goals, instances, scene, light)
    entries = planner.entries()
    lit = {key: entry for key, entry in light.entries.items() if not planner.instances[key].locked}
    if any(planner.owners.gives_backdrop(*act) for act in planner.acts):  # it replaces the rig's sky
        lit = {key: entry for key, entry in lit.items() if not key.startswith("world/backdrop_")}
    entries |= lit
    support = supports(goals.parsed, planner.instances, planner.sources, entries, planner.owners)
    if goals.holds:
        for name in scene.added_lights:  # a light that a further sentence adds starts faint next to the present light
            if power := entries.get(f"light/{name}/power"):
                faint = tuple(0.1 * v for v in power.lower)
                entries[f"light/{name}/power"] = replace(power, lower=faint, start=faint, prior=0.0)
        # of the supports a further sentence keeps only exposure and added lights
        support = {k: e for k, e in support.items() if k == "film/exposure" or e.prior == 0.0}
    if light.served:  # the rig sets the exposure; a limited grade keeps the contrast and colors of its light
        fog = entries.get(_FOG)
        if not (fog and fog.is_named):  # fog takes light, see `optimize.vector`
            support.pop("film/exposure", None)
        for key, (low, high) in _GRADES.items():
            entry = entries.get(key)
            if entry and entry.is_named:
                ends = entry.lower, entry.upper, entry.start or ()
                lower, upper, start = (tuple(min(max(v, low), high) for v in end) for end in ends)
                # usual: it does not open while claims are missed
                entries[key] = replace(entry, lower=lower, upper=upper, start=start or None, usual=True)
    entries |= support
    decided = Plan({key: entries[key] for key in instances}, tuple(dict.fromkeys(planner.notes)))
    return plan_with_picture(decided, goals, planner.instances, planner.vocabulary)


class _Planner:
    def __init__(self, goals: Goals, instances: dict[str, Instance], scene: SceneDescription, light: LightPlan) -> None:
        parsed = self.parsed = goals.parsed
        self.vocabulary = default_vocabulary()
        self.instances = {key: protected(i, parsed) for key, i in instances.items()}
        self.owners = Owners(parsed, self.instances, scene)
        stops = [i.value[0] for i in instances.values() if i.parameter.name in ("exposure", "grade_exposure")]
        self.sources = Sources(scene, exposure=sum(stops))
        self.notes = [*parsed.notes, *goals.notes()]
        self.agreed = Agreements()
        self.kept: dict[str, list[str]] = {}
        self.acts = [*acts(goals_without_rig(goals, light), self.owners), *grade_of(light)]
        # key -> the value that a parameter gets from a material that a word names, as "oak"
        self.of_materials: dict[str, Values] = {}
        for wish, effect in self.acts:
            if wish.attribute.slot == "material" and effect.mode in ("", "color"):
                for instance in self.owners.of(effect, wish.attribute):
                    given = effect, wish.attribute, instance, self.sources
                    own = painted(*given) if effect.color else within(instance.value, *effect_range(*given))
                    self.of_materials[instance.key] = own

    def entries(self) -> dict[str, PlanEntry]:
        """An entry for every instance, from the words alone."""
        for stage in range(STAGES):
            due = [(wish, effect) for wish, effect in self.acts if stage_of(effect) == stage]
            self.agreed.add([each for wish, effect in due for each in self._ranges(wish, effect)])
            scene, key = self.sources.scene, self.owners.lights.key
            facing = facing_radiance(self.instances, scene, self.agreed.value, key)
            world = backdrop = self._world("", scene.environment_luminance)
            if BACKDROP in self.instances:
                backdrop = self._world("backdrop_", scene.backdrop_luminance)
            self.sources = replace(self.sources, key=facing, world=world, backdrop=backdrop)
        entries = {key: self._entry(instance) for key, instance in self.instances.items()}
        self.notes += [*self.agreed.notes(), *self._unmet()]
        for reason, keys in self.kept.items():
            self.notes.append(f"{LEFT_ALONE}: {labels.titles(keys)} ({reason}).")
        return entries

    def _unmet(self) -> list[str]:
        """Notes on words whose main effect has nothing to change in the scene, as "rim light" in a scene with one light."""
        missing: dict[str, str] = {}
        for attribute in self.parsed.attributes:
            strong = [e for w, e in self.acts if w.attribute == attribute and not e.weak]
            most = min((e.priority for e in strong), default=0)
            main = [e for e in strong if e.priority == most]
            if main and not any(self.owners.of(e, attribute) for e in main):
                owner = main[0].owner
                what = f"{OWNERS[owner]} whose values may change so"
                if owner in ("rim", "fill", "others"):
                    role = "second" if owner == "others" else owner
                    what = f"light that could be the {role} light; add one"
                missing.setdefault(attribute.cause or attribute.word, what)
        return [f"'{w}' is not fully possible here: the scene has no {what}." for w, what in missing.items()]

    def _ranges(self, wish: Wish, effect: Effect) -> Iterator[WishedRange]:
        """The ranges that one effect of a wish asks for, one for each parameter that it changes."""
        for instance in self.owners.of(effect, wish.attribute):
            # modes that start from the present value
            relative = effect.mode in ("shade", "times", "plus", "near", "lightness")
            is_added = instance.owner in self.sources.scene.added_lights
            if is_added and effect.mode == "times" and effect.name == "power":
                if effect.lower[0] >= 1.0:  # a new light has no earlier power that it could exceed
                    continue
                instance = replace(instance, value=added_power(instance, self.sources))
            elif relative and instance.key in self.of_materials:
                instance = replace(instance, value=self.of_materials[instance.key])
            yield self._range(wish, effect, instance)

    def _range(self, wish: Wish, effect: Effect, instance: Instance) -> WishedRange:
        attribute = replace(wish.attribute, strength=wish.strength)
        shown = self.vocabulary.entries.get(attribute.entry)
        sources = replace(self.sources, own_color=self._own_color(instance.owner))
        if instance.parameter.name.startswith("backdrop"):
            sources = replace(sources, world=self.sources.backdrop)
        lower, upper = effect_range(effect, attribute, instance, sources)
        glows = effect.family == "material/emission" and not effect.mode and effect.lower[0] > 0
        if glows and wish.strength >= 1 and self._glow(instance.owner) > lower[0]:
            upper = max(upper, instance.value)  # a glow that is already stronger than asked for may stay
        lamp = f"{GLOW}{instance.owner}" if instance.parameter.group == "material" else instance.owner
        late = 2 * effect.weak + 2 * (effect.owner == "lights" and lamp not in self.owners.lights.key)
        # A named color comes before a word that only changes a color: "a teal ball, the ball darker".
        late += effect.mode == "times" and instance.parameter.kind == "color"
        # The prompt's own words come before what a mood implies.
        late += 6 * wish.implied
        reason = reason_of(attribute, shown.phrase if shown else "")
        ranks = effect.weak, effect.priority + late, is_usual(wish, effect)
        start = named_color(effect, attribute, instance, sources) if effect.color else None
        # A film's cast, and light that moves around its color, may change hue; a material keeps its hue.
        any_hue = effect.mode == "cast" or (effect.mode == "near" and OWNERS[effect.owner] != "material")
        return WishedRange(instance.key, lower, upper, wish, reason, *ranks, start, any_hue)

    def _world(self, part: str, level: float) -> WorldLook:
        """The look of the world (`part` "") or of its backdrop by the ranges so far; `level` is its image's mean luminance."""
        color, tint = (self.instances.get(f"world/{part}{name}") for name in ("color", "tint"))
        if color:
            return WorldLook(self.agreed.value(color))
        return WorldLook(tuple(v * level for v in self.agreed.value(tint)), level) if tint else WorldLook()

    def _own_color(self, owner: str) -> tuple[float, ...]:
        named = (a.color for a in self.parsed.attributes if a.kind == "subject" and a.color and not a.negated)
        found = (self.instances.get(f"material/{owner}/{name}") for name in ("base_color", "tint"))
        own = (srgb_from_linear(self.agreed.value(i)) for i in found if i)
        return next(named, None) or next(own, (1.0, 1.0, 1.0))

    def _glow(self, owner: str) -> float:
        strength, color = (self.instances.get(f"material/{owner}/{n}") for n in ("emission", "emission_color"))
        return strength.value[0] * max(color.value) if strength and color else 0.0

    def _entry(self, instance: Instance) -> PlanEntry:
        settled = self.agreed.of.get(instance.key)
        if instance.locked:
            if settled:
                self.kept.setdefault(instance.locked, []).append(instance.key)
            return PlanEntry.kept(instance, "")
        if not settled:
            return PlanEntry.kept(instance, "no word touches it: keeps the artist's value")
        if instance.parameter.family == "material/emission_color":
            # Many materials have a strength of 1 and a black emission color.
            asked = self.agreed.of.get(f"material/{instance.owner}/emission")
            if max(asked.upper[0] if asked else 0.0, self._glow(instance.owner)) <= 0.02:
                return PlanEntry.kept(instance, "does not glow: keeps the artist's value")
        lower, upper = clip(settled.lower, settled.upper, instance)
        winners = settled.winners
        start = winners[0].start and within(winners[0].start, lower, upper)
        value, (low, *_), (high, *_) = instance.value[0], lower, upper
        relative = any(claim.by for claim in winners[0].wish.claims)  # "softer" begins at an end of its range
        moved = value < 0.999999 * low or value > 1.000001 * high
        if instance.parameter.name in ("size", "angle") and (moved or relative):
            # well inside the range, on a log scale: shadow edges give weak gradients
            near, far = (low, high) if value - low < high - value else (high, low)
            start = (max(near, 0.01 * far) ** 0.25 * max(far, 0.01 * near) ** 0.75,)
        elif instance.key == _FOG and instance.value < lower:  # at the low end hardly any fog is visible
            start = (math.sqrt(lower[0] * upper[0]),)
        most, reason = min(d.priority for d in winners), "; ".join(dict.fromkeys(d.reason for d in winners))
        usual, any_hue = all(d.weak for d in winners), winners[0].any_hue
        return PlanEntry(lower, upper, most, reason, 0.0, usual=usual, any_hue=any_hue, start=start)
