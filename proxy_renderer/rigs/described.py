# SPDX-License-Identifier: Apache-2.0
"""The lights that a prompt describes one by one, each as a light of a rig: its type, direction, color and strength."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from ..color.floats import hex_from_srgb, mixed
from ..words.attributes import is_dark
from ..words.lexicon.rigs import Modifier, RigLight, RigTable
from ..words.lexicon.vocabulary import Vocabulary
from ..words.passage import LIGHTS
from ..words.types import Attribute

EDGES = ("rim", "kicker")  # parts that draw an edge from behind
FILLS = ("fill", "bounce")  # parts that open the shadows
FREE = ("key", "accent", "practical", "top")  # for lights whose use the prompt does not say, in order
# azimuth from the camera, in degrees, beyond which a light draws edges and leaves the visible side dark
BEHIND = 120.0
_EDGE = 128.0  # azimuth of an edge light behind the subject


@dataclass(frozen=True)
class DescribedLight:
    """A light that words describe."""

    part: str  # that it plays in the rig
    said: tuple[Attribute, ...]  # the words
    own: str = ""  # the scene's light that the words name; "" if none

    def is_mirrored(self, table: RigTable) -> bool:
        """True if words say that the other side gets such a light too."""
        return any(modifier.both for _, modifier in _places(self.said, table))


def described(said: Iterable[Attribute], table: RigTable) -> list[DescribedLight]:
    """The lights that the words `said` of a prompt describe, and do not only mention."""
    groups: dict[int, list[Attribute]] = {}
    for attribute in said:
        elsewhere = attribute.owners or attribute.cause or attribute.of_glows or is_dark(attribute)
        if attribute.kind in LIGHTS and not elsewhere:
            for number in attribute.phrases:
                groups.setdefault(number, []).append(attribute)
    # Groups that name the same source become one: "full moon ... cold moonlight".
    merged, of_source = dict[int, list[Attribute]](), dict[str, int]()
    for number, words in groups.items():
        source = source_of(words, table)
        colored = any(a.color for a in words)
        first = number if source is None or colored else of_source.setdefault(source.entry, number)
        merged.setdefault(first, []).extend(words)
    found: list[DescribedLight] = []
    groups = {n: words for n, words in merged.items() if _tells(words, table, len(merged))}
    for words in groups.values():
        for own in dict.fromkeys(name for a in words for name in a.lights) or {"": None}:
            taken = {each.part for each in found}
            free = (p for p in _parts_for(words, table, len(groups)) if p not in taken)
            if part := next(free, ""):
                found.append(DescribedLight(part, tuple(words), own))
    # Without a key, an edge light is the key if there is a fill, or if it is a sun: "golden hour backlight".
    parts = {light.part for light in found}
    edge = next((light for light in found if light.part in EDGES), None)
    if "key" in parts or edge is None:
        return found
    rigs = (table.rigs[a.entry] for a in edge.said if a.entry in table.rigs and not (a.color or a.negated))
    if parts.isdisjoint(FILLS) and not any(light.type == "SUN" for rig in rigs for light in rig.lights[:1]):
        return found
    return [replace(light, part="key") if light is edge else light for light in found]


def _tells(words: Sequence[Attribute], table: RigTable, lights: int) -> bool:
    """True if words single a light out: by two sources, a direction or a light of the scene.

    If there are several lights (`lights` is their number), one source, role, color or color temperature is enough.
    """
    said = [a for a in words if not a.negated]
    sources = [a for a in said if _source(a, table)]
    if len(sources) > 1 or _places(said, table) or any(a.lights for a in said):
        return True
    # enough if there are several lights
    colored = bool(sources) or any(a.role or a.color for a in said)
    return lights > 1 and (colored or any((m := table.modifier(a.entry)) and m.kelvin for a in said))


def _parts_for(words: Sequence[Attribute], table: RigTable, lights: int) -> tuple[str, ...]:
    """The parts that a light may play, the likeliest first."""
    nouns = {word for a in words for word in a.thing.split()}
    role = next((a.role for a in words if a.role), "")
    if role == "rim" or not nouns.isdisjoint(EDGES):
        return EDGES
    if role == "fill" or not nouns.isdisjoint(FILLS):
        return FILLS[::-1] if "bounce" in nouns else FILLS
    if added := [part for a in words for part in table.parts(a.entry)]:
        return *added, *FREE
    azimuth, _ = _direction(words, table)
    if role != "key" and azimuth is not None and abs(azimuth) > BEHIND and lights > 1:
        return (*EDGES, *FREE)
    return FREE


def composed(light: DescribedLight, lights: Sequence[RigLight], table: RigTable, vocabulary: Vocabulary) -> RigLight:
    """The rig light that words describe; it replaces the light of the same part in the rig's `lights`, if any."""
    base, key = (next((x for x in lights if x.part == part), None) for part in (light.part, "key"))
    made = _template(light, base, key, table)
    azimuth, elevation = _direction(light.said, table)
    if azimuth is not None and not (light.part in FILLS and azimuth == table.modifiers["side light"].azimuth):
        # An edge light on a side stands there behind the subject, and a fill "from the side" stays on the dark side.
        if light.part in EDGES and 20.0 < abs(azimuth) < _EDGE:
            azimuth = math.copysign(_EDGE, azimuth)
        made = replace(made, azimuth=azimuth, mirrored=False, through="")
    if elevation is not None:
        made = replace(made, elevation=elevation)
    if any((m := table.modifier(a.entry)) and m.kelvin and not a.negated for a in light.said):
        made = replace(made, color="")  # "cold backlight" where the rig has an orange one
    if light.own and base in table.plain.lights and source_of(light.said, table) is None:
        made = replace(made, color="", kelvin=0.0)  # it keeps its color, unless a word gives it one
    for attribute in light.said:
        modifier = table.modifier(attribute.entry)
        if attribute.negated:
            modifier = modifier.reversed() if modifier else None
        if attribute.color and not attribute.negated:
            made = replace(made, color=tint_of(attribute, vocabulary), kelvin=0.0)
        elif modifier:
            made = replace(modifier, azimuth=None, elevation=None).change(made, attribute.strength)
    if light.part != "key":
        made = replace(made, stops=made.stops + 1.6 * _brighter(light.said, table, vocabulary))
    return limited(made)


def tint_of(attribute: Attribute, vocabulary: Vocabulary) -> str:
    """The color that a word gives a light, "#rrggbb": "slightly yellow" is nearer to white, but "faint yellow" is not."""
    assert attribute.color
    weaker = any("lamp" in vocabulary.adjectives.get(word, {}) for word in attribute.word.split())
    # squared, because gels are purer than paint of the same name
    white = 0.0 if weaker else 1.0 - min(attribute.strength, 1.0) ** 2
    return hex_from_srgb(mixed(attribute.color, (1.0, 1.0, 1.0), white))


def limited(light: RigLight) -> RigLight:
    """The light with a size of at most the largest that lights of its type have."""
    widest = {"SUN": 45.0, "AREA": 5.0, "SPOT": 1.0, "POINT": 1.0}
    return replace(light, size=min(light.size, widest[light.type]))


def source_of(words: Sequence[Attribute], table: RigTable) -> Attribute | None:
    """The word that names a light's source; None if none. The last of several counts, a window only without others."""
    # A "tungsten spot" is a spot, and moonlight from a window is the moon.
    sources = [(a, lamp) for a in words if (lamp := _source(a, table))]
    lamps = [a for a, lamp in sources if lamp.type == "SUN" or not lamp.through]
    return next(reversed(lamps or [a for a, _ in sources]), None)


def _source(attribute: Attribute, table: RigTable) -> RigLight | None:
    """The rig light of the source that a word names: "moon"; None for words that name no source, or a whole setup."""
    named = table.is_a_light(attribute.entry, attribute.word) and not (attribute.color or attribute.negated)
    return table.rigs[attribute.entry].lights[0] if named else None


def _template(light: DescribedLight, base: RigLight | None, key: RigLight | None, table: RigTable) -> RigLight:
    """The light that words then change: of the named source, else `base`, the rig's of this part, else a plain one.

    `key` is the rig's key light; lights other than edges start on the side opposite to it.
    """
    has_rig = light.part in (*EDGES, *FILLS, "background")  # one that adds a light of that part
    plain = (table.rigs[f"{light.part} light"] if has_rig else table.plain).lights[0]
    stops = -0.5 if light.part in FREE[1:] else plain.stops
    made = replace(base, stops=max(base.stops, stops)) if base else replace(plain, stops=stops)
    sources = [a for a in light.said if _source(a, table)]
    head = source_of(light.said, table)
    if head and not (base and light.part == "key"):  # the rig's own key stays
        lamp = _source(head, table)
        assert lamp
        reach = lamp.reach if light.part in ("key", "background") else "subject"
        made = replace(lamp, stops=made.stops, reach=reach)
    for other in (lamp for a in sources if a is not head and (lamp := _source(a, table))):
        if other.through and other.type != "SUN":  # a window
            made = replace(made, through=other.through)
        else:
            made = replace(made, color=other.color, kelvin=other.kelvin)
    if key is not None and light.part not in ("key", "background", *EDGES):
        away = abs(made.azimuth) if base and not head else 100.0  # on the side opposite to the key
        made = replace(made, azimuth=-away if key.azimuth > 0 else away)
    return replace(made, part=light.part, own=light.own)


def _places(said: Iterable[Attribute], table: RigTable) -> list[tuple[str, Modifier]]:
    found = [(a.entry, table.modifier(a.entry)) for a in said if not (a.negated or a.color)]
    return [(entry, m) for entry, m in found if m and "direction" in m.aspects]


def _direction(said: Iterable[Attribute], table: RigTable) -> tuple[float | None, float | None]:
    """(azimuth, elevation) that words give a light, degrees, each None if not given; "back left" is the mean of two."""
    places = _places(said, table)
    turns = {entry: m.azimuth for entry, m in places if m.azimuth is not None}
    if len(turns) > 1:  # "side" counts only without another direction
        turns.pop("side light", None)
    angles = [math.radians(turn) for turn in turns.values()]
    rises = [m.elevation for _, m in places if m.elevation is not None]
    azimuth = math.degrees(math.atan2(sum(map(math.sin, angles)), sum(map(math.cos, angles))))
    return azimuth if angles else None, max(rises, key=abs) if rises else None


def _brighter(said: Iterable[Attribute], table: RigTable, vocabulary: Vocabulary) -> float:
    """Stops that words such as "faint" and "strong" add to a light, also inside another look word: "dim cyan"."""
    entries: dict[str, None] = {}
    for attribute in said:
        rows = [vocabulary.adjectives.get(word, {}) for word in attribute.word.split()]
        lamps = (row.get("lamp") or row.get("light", "") for row in rows)
        entries |= dict.fromkeys([attribute.entry, *lamps])
    stops = [m.exposure for entry in entries if (m := table.modifier(entry))]
    return min([0.0, *stops]) or max([0.0, *stops])
