# SPDX-License-Identifier: Apache-2.0
"""The rig that a prompt asks for: a setup, changed by the other words."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ..color.floats import chroma, hex_from_srgb, lab_from_srgb, mixed, srgb_from_hex, srgb_from_linear
from ..goals.resolve import Goals
from ..planning.light_levels import kelvin_color
from ..words.attributes import is_dark
from ..words.lexicon.languages import singular
from ..words.lexicon.rigs import KINDS, TIMES, Modifier, Rig, RigLight, RigTable
from ..words.lexicon.vocabulary import GLOWING, Vocabulary
from ..words.passage import LIGHTS
from ..words.types import Attribute
from .combined import at_an_hour, deepened, denser, in_a_mood, in_a_style, under_named_sky, with_source
from .described import BEHIND, EDGES, FILLS, FREE, DescribedLight, composed, described, limited, source_of, tint_of

_STYLED = {"source": ("style", "film", "mood", "place"), "style": ("mood", "place"), "time": ("style", "film")}
"""Kind of a setup -> kinds of other setups whose darkness and grade it takes over: strip lights in a black studio."""
_LIT = (*LIGHTS, "ambience")  # kinds of things whose color words color the rig's lights, as gels do
_OF_LIGHT = (*_LIT, "tone", "whole", "shadow")
_PARTS = {"rim": EDGES, "fill": FILLS, "key": ("key",)}  # role of a light in words -> parts of a rig
_DARKER, _DIMMER = "darker surface", 1.3  # entry of surroundings that are only darker, and by how many stops
_DARK_WORDS = (_DARKER, "dark surface", "black surface", "dark surroundings", "dark")
_EXPOSURES = (-2.2, 1.0)
_PRACTICAL = "practical lamp"  # the rig of a lamp in the picture


Asked = tuple[tuple[str, ...], tuple[str, ...]]
"""Parts of a rig, and aspects of their light: "direction", "color", "contrast", "rim", "rest". () stands for all."""
_ALL: Asked = ((), ())


@dataclass(frozen=True)
class ChosenRig:
    """The rig of a prompt."""

    rig: Rig  # with the changes that modifiers make to it
    words: Mapping[str, Asked]  # word of the prompt that the rig shows -> what the word asks of the rig
    served: tuple[Attribute, ...]  # the attributes that the rig fulfills; they have no other effect
    anew: bool = False  # whether the scene's own lights play no part in it


def chosen_rig(goals: Goals, table: RigTable, vocabulary: Vocabulary, anew: bool = False) -> ChosenRig | None:
    """The rig that a prompt asks for; None if it asks for none, so that each word acts on the scene's own lights.

    With `anew`, a light that the prompt names is a further one, though the scene has such a light: "and a rim light".
    """
    # words that name different glowing objects act on these alone
    attributes = [a for a in goals.parsed.attributes if a.entry]
    apart = len({a.lights for a in attributes if a.of_glows}) > 1
    said = [a for a in attributes if not ((apart and a.of_glows) or (a.cause and a in goals.overruled))]
    lights = described(said, table)
    of_lights = [a for light in lights for a in light.said]
    heads = [source_of(light.said, table) for light in lights if light.part == "key"]
    # in "overcast daylight, purple rim" the weather is still the setup
    lamps_or_turns = [a for a in of_lights if table.is_a_light(a.entry, a.word) or a.entry in table.modifiers]
    setups = _setups([a for a in said if a not in lamps_or_turns or a in heads], table)
    gels = _gels([a for a in said if a not in of_lights], setups, table)
    turns = [a for a in said if (m := table.modifier(a.entry)) and "direction" in m.aspects]
    directed = any(a.kind in _OF_LIGHT and not (a.negated or a.cause) for a in turns)
    lamps = _lit_lamps(said, table)
    added = {part for a in said if _adds(a, table, vocabulary, anew) for part in table.parts(a.entry)}
    if not setups and len(gels) < 2 and not (lights or directed or lamps or added):
        return None
    parts = {light.part for light in lights} | added | ({"practical"} if lamps else set())
    colored = any(a.color or ((m := table.modifier(a.entry)) and m.kelvin) for a in (*of_lights, *gels))
    build = _Build(_first(setups, gels, lights, parts, table), table, vocabulary, colored)
    for attribute in setups:
        build.take_setup(attribute)
    build.describe(lights)
    left = (a for a in said if a not in build.served and not a.cause)
    # A light is added before it is made warm.
    for attribute in sorted(left, key=lambda a: not table.parts(a.entry)):
        if table.parts(attribute.entry):
            build.add(attribute)
        elif build.may_modify(attribute):
            build.modify(attribute, _PARTS.get(attribute.role, ("key",)))
        else:
            build.darken(attribute, said)
    for lamp in lamps:
        build.light_up(lamp, said)
    for gel in gels:
        build.color(gel, _PARTS.get(gel.role, ()))
    moods = (a for a in said if a.cause and a.slot == "lighting" and not a.owners)
    least = min(_EXPOSURES[0], build.first.exposure)
    rig = under_named_sky(build.rig, said)
    first, key = ([abs(x.azimuth) > BEHIND for x in each.lights[:1]] for each in (build.first, rig))
    if first == [False] and key == [True]:
        rig = replace(rig, exposure=min(rig.exposure, table.rigs["back light"].exposure))
    rig = replace(rig, exposure=min(max(rig.exposure, least), _EXPOSURES[1]))
    served = (*build.served, *(a for a in moods if a not in build.served))
    return ChosenRig(rig, build.words, served, anew)


def _first(
    setups: list[Attribute], gels: list[Attribute], lights: list[DescribedLight], parts: set[str], table: RigTable
) -> Rig:
    """The rig that words then change; if they only add lights for `parts` without a key, the scene's light stays."""
    if setups:
        return table.rigs[setups[0].entry]
    if len(gels) > 1:
        return table.rigs["neon light"]
    if any(a.role == "rim" for light in lights if light.part == "key" for a in light.said):
        return table.rigs["back light"]
    if not parts or "key" in parts:
        return table.plain
    says = "The scene stays lit as it is; lights are added to that."
    return replace(table.plain, says=says, own=0.0, world=None, lights=())


class _Build:
    """The construction of a rig: words change a first rig one after the other."""

    def __init__(self, first: Rig, table: RigTable, vocabulary: Vocabulary, names_light_colors: bool) -> None:
        self.first, self.rig, self.table, self.vocabulary = first, first, table, vocabulary
        self.words: dict[str, Asked] = {}
        self.served: list[Attribute] = []
        self._colored = 0
        self._in_a_mood = False
        self._names_light_colors = names_light_colors  # if so, moods bring no colored lights of their own
        self._turned: set[tuple[str, ...]] = set()  # groups of parts that a word has given a direction

    def take_setup(self, attribute: Attribute) -> None:
        """Applies a word that stands for a setup: the first setup is the rig already, others are combined with it."""
        other = self.table.rigs[attribute.entry]
        self.served.append(attribute)
        if other.name == self.first.name:
            self.words.setdefault(attribute.cause or attribute.word, _ALL)
        if other.name == self.first.name or attribute.cause:
            return
        asked: Asked
        keys = [rig.lights[0].type for rig in (self.rig, other) if rig.lights]
        hours = other.kind in TIMES and self.first.kind in TIMES and other.has_dark_sky == self.first.has_dark_sky
        if other.kind == "source":
            has_signs = other.has_signs and self.first.has_signs  # the hour's own signs stay
            self.rig = self.rig if has_signs else with_source(self.rig, other)
            asked = ("accent",), ("color",)
        elif hours and keys == ["SUN", "SUN"] and self.table.is_a_light(attribute.entry, attribute.word):
            # more about the sun of an hour: "early morning, low golden sun"
            self.rig = replace(self.rig, lights=(*other.lights[:1], *self.rig.lights[1:]))
            asked = ("key",), ("color",)
        elif self.first.has_dark_sky and other.is_overcast:  # the air of a weather by night
            self.rig, asked = replace(self.rig, air=denser(self.rig, other)), (("key",), ("rest",))
        elif other.kind in TIMES and self.first.kind not in ("time", "hour"):
            self.rig, asked = at_an_hour(self.rig, other), (("key",), ("rest",))
        elif other.kind in _STYLED.get(self.first.kind, ()):
            self.rig, asked = in_a_style(self.rig, other), (("key",), ("contrast", "rest"))
        elif other.kind == "mood" and self.first.kind in (*TIMES, "place"):
            self.rig = self.rig if self._in_a_mood else in_a_mood(self.rig, other, edges=not self._names_light_colors)
            self._in_a_mood, asked = True, (EDGES, ("rim", "color"))
        else:
            return
        self.words.setdefault(attribute.word, asked)

    def describe(self, lights: Sequence[DescribedLight]) -> None:
        """Gives the rig the lights that words describe. If these are several, a source's rig loses its other lights."""
        if len(lights) > 1 and (self.first.kind == "source" or self.first.name == "back light"):
            parts = {"key", *(light.part for light in lights)}
            self.rig = replace(self.rig, lights=tuple(x for x in self.rig.lights if x.part in parts))
        for light in lights:
            if light.part in FREE:
                # Without a named role it gets the part of the rig's light that has its name: in a rig for the night a lamp
                # becomes that rig's lamp, not its moon.
                nouns = {singular(word) for a in light.said for word in a.thing.split()}
                named = (x.part for x in self.rig.lights if nouns & x.names)
                light = replace(light, part=next(named, light.part))
            made = composed(light, self.rig.lights, self.table, self.vocabulary)
            others = tuple(x for x in self.rig.lights if x.part != light.part)
            self.rig = replace(self.rig, lights=(made, *others) if light.part == "key" else (*others, made))
            if light.is_mirrored(self.table) and light.part != "accent":
                other = "kicker" if light.part == "rim" else "accent"
                twin = replace(made, part=other, azimuth=-made.azimuth)
                rest = tuple(x for x in self.rig.lights if x.part != other)
                self.rig = replace(self.rig, lights=(*rest, twin))
            for attribute in light.said:
                self._take_described(attribute, light.part)

    def _take_described(self, attribute: Attribute, part: str) -> None:
        """Records a word of a described light; a word about the key also changes the rig's contrast and exposure."""
        modifier = self.table.modifier(attribute.entry)
        if attribute in self.served:
            return
        if attribute.color:
            self._take(attribute, (part,), ("color",))
        elif modifier:
            if part == "key":
                modifier = modifier.reversed() if attribute.negated else modifier
                self.rig = deepened(self.rig, modifier, attribute.strength)
            self._take(attribute, (part,), modifier.aspects)
        elif attribute.entry in self.table.rigs:
            self._take(attribute, (part,), ("rim", "color"))

    def add(self, attribute: Attribute) -> None:
        """Adds the lights of a word's rig, "rim light", or removes such lights if the word is negated."""
        parts, added = self.table.parts(attribute.entry), self.table.rigs[attribute.entry].lights
        rest = tuple(light for light in self.rig.lights if light.part not in parts)
        self.rig = replace(self.rig, lights=rest if attribute.negated else (*rest, *added))
        self._take(attribute, parts, ("rim", "color"))

    def light_up(self, lamp: Attribute, said: Sequence[Attribute]) -> None:
        """Adds the light of a lamp in the image; the word `lamp` turns it on, and words in `said` may color it."""
        light = replace(self.table.rigs[_PRACTICAL].lights[0], worn=frozenset(lamp.owners))
        color = next((a for a in said if a.color and not a.negated and a.owners == lamp.owners), None)
        if color and not is_dark(color):
            light = replace(light, color=tint_of(color, self.vocabulary), kelvin=0.0)
        # it replaces the rig's own lamp, but no other lamp that the prompt names
        others = (x for x in self.rig.lights if x.worn or x.part != light.part)
        self.rig = replace(self.rig, lights=(*others, light))

    def may_modify(self, attribute: Attribute) -> bool:
        """True if a word changes lights of the rig; if the scene's own light stays, it has to be about added lights."""
        of_added = any(light.part in _PARTS.get(attribute.role, ()) for light in self.rig.lights)
        of_rig = of_added or not self.first.keeps_own_light
        of_light = attribute.kind in _OF_LIGHT or bool(attribute.role)
        return of_light and of_rig and not attribute.owners and bool(self.table.modifier(attribute.entry))

    def modify(self, attribute: Attribute, parts: Sequence[str]) -> None:
        """Changes the lights of some parts, and the rig's contrast and exposure, by the modifier of a word."""
        modifier = self.table.modifier(attribute.entry) or Modifier()
        modifier = modifier.reversed() if attribute.negated else modifier
        if modifier.azimuth is not None:
            if attribute.kind == "shadow":  # a shadow to the left is light from the right
                modifier = replace(modifier, azimuth=-modifier.azimuth)
            if tuple(parts) in self._turned:  # the first direction counts
                modifier = replace(modifier, azimuth=None, elevation=None)
            self._turned.add(tuple(parts))
        of_a_light = modifier != Modifier(exposure=modifier.exposure, contrast=modifier.contrast)
        lights = [
            limited(modifier.change(light, attribute.strength)) if light.part in parts else light
            for light in (self._with_parts(parts) if of_a_light else self.rig.lights)
        ]
        self.rig = deepened(replace(self.rig, lights=tuple(lights)), modifier, attribute.strength)
        self._take(attribute, tuple(parts), modifier.aspects)

    def darken(self, attribute: Attribute, said: Sequence[Attribute]) -> None:
        """Makes all but the subject black, or only darker, if a word says so: "everything else falls into black"."""
        others = attribute.thing in self.vocabulary.lists["others"]
        around = others or attribute.kind in ("surroundings", "sky")
        if attribute.negated or not around or (attribute.owners and not others):
            return
        if attribute.color is not None:
            lab = lab_from_srgb(attribute.color)
            dark = lab[0] < 20.0 and chroma(lab) < 14.0  # "dark burgundy" is not black
        else:  # "darken the backdrop to a dusty teal" leaves nothing black
            dark = attribute.entry in _DARK_WORDS and not any(a.color and a.thing == attribute.thing for a in said)
        if not dark:
            return
        world = sky = -6.5  # stops that leave all but the subject black
        own = -10.0
        if attribute.entry == _DARKER:
            world, sky = (max((-2.0 if v is None else v) - _DIMMER, -6.5) for v in (self.rig.world, self.rig.sky))
            own = min(self.rig.own, -_DIMMER)
        self.rig = replace(self.rig, sky=sky, world=world, own=own)
        self.rig = replace(self.rig, lights=tuple(x for x in self.rig.lights if x.reach != "background"))
        self._take(attribute, ("key",), ("rest",))

    def color(self, gel: Attribute, parts: Sequence[str]) -> None:
        """Gives a color to the lights of some parts; without parts, first to the key, then to an accent, then to the rim."""
        if not parts:
            parts = (("key", "accent", "rim")[min(self._colored, 2)],)
            self._colored += 1
        lights = []
        for light in self._with_parts(parts):
            if light.part in parts:
                color = tint_of(gel, self.vocabulary)
                if gel.kind == "ambience" and light.type == "SUN" and light.kelvin:
                    # In a mood's color a sun or moon keeps half of its own: "a quiet blue night".
                    own = srgb_from_linear(kelvin_color(light.kelvin))
                    color = hex_from_srgb(mixed(srgb_from_hex(color), own, 0.5))
                light = replace(light, color=color, kelvin=0.0)
            lights.append(light)
        self.rig = replace(self.rig, lights=tuple(lights))
        self._take(gel, tuple(parts), ("color",))

    def _with_parts(self, parts: Sequence[str]) -> tuple[RigLight, ...]:
        """The rig's lights and, if none plays one of `parts`, a new light of the first part, opposite to the key."""
        lights = self.rig.lights
        if not lights or any(light.part in parts for light in lights):
            return lights
        key, part = lights[0], parts[0]
        side = -1.0 if key.azimuth > 0 else 1.0
        aside, stops = (150.0, 1.0) if part == "rim" else (95.0, -0.3 if part == "accent" else -2.0)
        more = RigLight(part, "AREA", side * aside, 20.0, True, 2.8, 1.2, 5600.0, "", stops)
        return (*lights, more)

    def _take(self, attribute: Attribute, parts: tuple[str, ...], aspects: tuple[str, ...]) -> None:
        self.served.append(attribute)
        if aspects and not attribute.negated:
            self.words.setdefault(attribute.word, (parts, aspects))


def _lit_lamps(said: Sequence[Attribute], table: RigTable) -> list[Attribute]:
    """The words by which lamps in the image are on, one for each lamp: "the table lamp glows amber"."""
    names = table.rigs[_PRACTICAL].lights[0].names
    burn = (a for a in said if a.entry == GLOWING and a.owners and not a.negated)
    return list({a.owners: a for a in burn if names & {singular(word) for word in a.thing.split()}}.values())


def _setups(said: Sequence[Attribute], table: RigTable) -> list[Attribute]:
    """The words that stand for setups (whole rigs), the most important first."""
    graded = {a.word for a in said if a.grades}
    every = [a for a in said if a.entry in table.rigs and not (a.negated or a.color or a.grades)]
    every = [a for a in every if not (table.rigs[a.entry].adds or a.cause in graded)]
    rigs = {a.entry: table.rigs[a.entry] for a in every}
    night = any(rig.kind in TIMES and rig.has_dark_sky for rig in rigs.values())
    signs = any(rig.kind in TIMES and rig.has_signs for rig in rigs.values())

    def rank(attribute: Attribute) -> tuple[bool, bool, int]:
        """Words of the prompt come before those that a mood stands for; then the kind of the rig decides.

        At night a weather without a sun comes last: "rainy midnight" is lit as the midnight. Colored signs come after an
        hour that has such signs: "rainy night, neon".
        """
        rig = rigs[attribute.entry]
        late = (night and rig.is_overcast) or (signs and rig.kind == "source" and rig.has_signs)
        return bool(attribute.cause), late, KINDS.index(rig.kind)

    every.sort(key=rank)
    # A word that can also change a setup, such as "backlit", counts only if there is no other.
    return [a for a in every if a.entry not in table.modifiers] or every[:1]


def _adds(attribute: Attribute, table: RigTable, vocabulary: Vocabulary, anew: bool) -> bool:
    """True if a word adds a light to a rig; without `anew`, only one without wishes of its own: "background light"."""
    entry = vocabulary.entries.get(attribute.entry)
    is_said = not (attribute.negated or attribute.cause)
    return is_said and bool(table.parts(attribute.entry)) and (anew or not (entry and entry.wishes))


def _gels(said: Sequence[Attribute], setups: Sequence[Attribute], table: RigTable) -> list[Attribute]:
    """The color words for light: those about lights, and those of neon signs, if the rig has signs."""
    colors = [a for a in said if a.color and not (a.negated or a.cause or is_dark(a))]
    signs = any(light.color for a in setups for light in table.rigs[a.entry].lights)
    neon = {a.thing for a in said if a.color and a.entry.startswith("neon ") and signs}
    tubes = [a for a in said if a.color and not a.cause and a.thing in neon and a.kind not in _LIT]
    return [a for a in colors if a.kind in _LIT] + tubes
