# SPDX-License-Identifier: Apache-2.0
"""Goals of a further sentence such as "a bit warmer", which are relative to the image that it goes on from."""

import math
import re
from collections.abc import Iterator
from dataclasses import replace

from ..color.floats import hex_from_srgb, oklab_from_srgb, srgb_from_oklab
from ..schema import FAMILIES, Values
from ..words.lexicon.entries import Effect
from ..words.lexicon.languages import singular, thing_words
from ..words.lexicon.quantities import ClaimText
from ..words.lexicon.rigs import rig_table
from ..words.lexicon.vocabulary import Vocabulary
from ..words.types import GLOW, Attribute, SceneDescription
from .relative import compares
from .resolve import Goals, resolved
from .wish import Wish, wishes_of

_OF = re.compile(r"\b(?:for|on|of|to) (?:the|her|his|its|this|that) (?:\w+ ){0,2}?(\w+)(?=$|[,;.]| instead\b)", re.I)
_BARE = ("more", "less", "a bit more", "a bit less", "much more", "much less")
_SIDES = ("front", "back", "rear", "side", "behind")
_OF_SOMETHING = ("stronger", "weaker")  # comparatives that say nothing without a noun
_SMALL = re.compile(r"\b(?:bit|little|slightly|subtly|gently)\b")
_LARGE = re.compile(r"\b(?:much|very|strongly|far|extremely)\b")
_NOTICED = 2.0  # noticeable steps of a measure for one of `_steps`; for warmth, one of `_steps` is a cast of about 3 ΔE
_LEAST, _MOST = 0.8, 1.3  # shares of the requested change between which a word is satisfied
_REACH = 0.07  # share of a parameter's range by which its value may move, up or down, for one of `_steps`
_BRIGHTER = 2.0**0.5  # factor for one of `_steps` on a value of a log scale that no measure reads: half a stop
_WARMER = 1.17  # the same for a color temperature: 6500 K to 5600 K
_NO_AMOUNTS = ("hardness", "light_color", "cast")  # quantities for which "twice as much" means no number
_EXACT = 0.01  # share by which "twice as much" may be missed


def further(
    goals: Goals, vocabulary: Vocabulary, scene: SceneDescription, factor: float = 0.0, text: str = ""
) -> Goals:
    """Goals of a further sentence, which are relative to the present image of a scene and keep the rest of that image.

    Args:
        goals: The goals of the sentence, read like a prompt that stands alone.
        factor: The amount in the sentence: 2 for "twice as much fog", 0.5 for "half as red"; 0 if it names none.
        text: The sentence from the word that the factor belongs to: "more fog"; "" without a factor.
    """
    every = (*goals.wishes, *(each.wish for each in goals.lost))
    originals = goals.parsed.attributes
    attributes = [_as_light(each, _fixture(each, scene), vocabulary) for each in originals]
    compared = [a for a in attributes if not a.cause and compares(a, (), vocabulary)]
    # "less yellow, more like rose gold" asks for rose gold
    named = {a.owners for a in attributes if a.slot in ("color", "material") and a not in compared and not a.cause}
    # the word that the factor belongs to: "red" of "half as red, more contrast"
    first = next((a for a in compared if text.startswith(a.word)), None)
    places = _places(goals)
    said, wishes, notes, left_out = list[Attribute](), list[Wish](), list(goals.parsed.notes), set[str]()
    for original, attribute in zip(originals, attributes, strict=True):
        if original.cause in left_out:  # what a mood implies goes with it
            continue
        if why := _why_not(attribute, goals, places):
            left_out.add(attribute.word)
            notes.append(f"'{attribute.word}' is not used: {why}.")
            continue
        mine = [replace(wish, attribute=attribute) for wish in every if wish.attribute is original]
        if attribute in compared:
            own_factor = factor if first in (None, attribute) else 0.0
            noun = next((a for a in attributes if _is_noun_of(a, attribute)), None)
            if attribute.less and attribute.color and attribute.owners in named:
                mine = []
            elif attribute.color:
                mine = [*_recolored(attribute, vocabulary, scene, own_factor)]
            else:
                mine = [*_compared(attribute, vocabulary, own_factor, noun)]
        elif any(_is_noun_of(attribute, each) or _names_light_of(attribute, each) for each in compared):
            attribute, mine = replace(attribute, entry=""), []
        elif _changes_own_light(attribute):  # of the lights that are there, without a rig
            mine = [replace(wish, attribute=replace(attribute, entry="")) for wish in mine]
        elif attribute.role in ("rim", "fill"):  # a further light has to change the present image visibly
            mine = [replace(wish, claims=tuple(map(_beside, wish.claims))) for wish in mine]
        said.append(mine[0].attribute if mine else attribute)
        wishes += mine
    return replace(resolved(replace(goals.parsed, attributes=said, notes=notes), wishes), holds=True)


def _why_not(attribute: Attribute, goals: Goals, places: list[Attribute]) -> str:
    """The reason to leave out a word of a further sentence, such as an object that the scene lacks; "" to use it.

    `places` are the result of `_places`.
    """
    if attribute.word in _BARE:
        return "the sentence does not name what there is to be more or less of"
    if attribute.word in _SIDES:  # "front" of "front car" is no light
        return "it names no light: write 'light from the front'"
    text = goals.parsed.prompt.lower()
    # "snowy" of "the snowy peaks"
    of_place = attribute.slot == "mood" and any(f"{attribute.word} {place.word}" in text for place in places)
    if attribute in places or of_place:
        return "it says where in the image, not how it is to look"
    if attribute.owners or attribute.lights or attribute.role:
        return ""
    if goals.parsed.undone:
        return "it is of something that would have to be added"
    noun = _absent_noun(attribute, goals, places)
    return f"there is no '{noun}' in the scene" if noun else ""


def _absent_noun(attribute: Attribute, goals: Goals, places: list[Attribute]) -> str:
    """The noun that a word without a target belongs to, if the scene lacks its object; else ""."""
    text, word, ignored = goals.parsed.prompt.lower(), attribute.word.lower(), goals.parsed.ignored
    unread = [noun for noun in ignored if _follows_article(noun, text)]  # "screens" in "let the screens glow"
    things = [noun for noun in ignored if thing_words().get(noun)]
    absent = [*unread, *things, *(place.word for place in places), *goals.parsed.absent]
    unnamed = attribute.kind == "subject" and attribute.thing.lower() not in text
    next_to_it = any(f"{noun} {word}" in text or f"{word} {noun}" in text for noun in unread)  # "the pot warmer"
    is_verb = text.startswith(f"{word} the ")  # "fade the blotches"
    needs_noun = unnamed or next_to_it or is_verb or word.split()[-1] in _OF_SOMETHING
    return absent[0] if absent and needs_noun else ""


def _places(goals: Goals) -> list[Attribute]:
    """The words that only name a place in the image: "trees" in "between the trees", "rock" in "green on the rock"."""
    text, attributes = goals.parsed.prompt.lower(), goals.parsed.attributes
    nouns = {noun.lower() for noun in _OF.findall(text)}
    settings = (a for a in attributes if a.slot == "setting" and _follows_article(a.word.split()[-1], text))
    substances = (a for a in attributes if a.slot == "material" and not a.owners and a.word in nouns)
    return [*settings, *substances]


def _follows_article(noun: str, text: str) -> bool:
    """True if an article or a possessive stands before a word, with one word between at most: "the snowy peaks"."""
    return bool(re.search(rf"\b(?:the|her|his|its|my|these|those) (?:\w+ )?{re.escape(noun)}\b", text))


def _fixture(attribute: Attribute, scene: SceneDescription) -> tuple[str, ...]:
    """Names of all lights and glows that `attribute.thing` names: a lamp is often a light inside a bulb that glows.

    For a role, the lights that have its name: "Vibe Rim". The scene's key comes first. () if the word is about the sky,
    or about no light with that name.
    """
    noun = {attribute.role} if attribute.role else {singular(word) for word in attribute.thing.lower().split()}

    def is_called_so(name: str) -> bool:
        return bool(noun) and noun <= {singular(word) for word in re.split(r"[\W_\d]+", name.lower())}

    lights = [name for name in scene.lights if is_called_so(name)]
    if attribute.kind == "sky" or not (attribute.lights or lights):
        return ()
    glows = [
        GLOW + name for name in scene.glows if name in scene.looks and any(map(is_called_so, scene.looks[name].worn))
    ]
    found = dict.fromkeys((*attribute.lights, *lights, *glows))
    return tuple(sorted(found, key=lambda name: name not in scene.lights or scene.lights[name].role != "key"))


def _as_light(attribute: Attribute, lights: tuple[str, ...], vocabulary: Vocabulary) -> Attribute:
    """The attribute, bound to `lights` in its word's sense for light: "brighter" of a lamp is about light, not paint.

    Unchanged without `lights`, or if the word has no such sense.
    """
    if lights and attribute.lights:
        return replace(attribute, lights=lights)
    if not lights or attribute.slot not in ("color", "lighting"):
        return attribute
    word = attribute.word.split()[-1]
    rows = (vocabulary.adjectives.get(each, {}) for each in (word, *vocabulary.stems(word, "comparative")))
    entry = next((row.get("lamp") or row["light"] for row in rows if {"lamp", "light"} & row.keys()), "")
    if not entry:
        return attribute
    return replace(attribute, entry=entry, slot="lighting", kind="light", region="whole", owners=(), lights=lights)


def _is_noun_of(attribute: Attribute, compared: Attribute) -> bool:
    """True if `attribute` only is the noun that `compared` describes: "fog" in "fog thinner", which asks for no fog."""
    return attribute is not compared and attribute.word == compared.thing and attribute.slot == "atmosphere"


def _changes_own_light(attribute: Attribute) -> bool:
    """True if a word changes power or color of lights in the scene ("lamp off"), not their direction or setup."""
    table = rig_table()
    modifier = table.modifier(attribute.entry)
    turns = modifier is not None and "direction" in modifier.aspects
    return bool(attribute.lights) and attribute.entry not in table.rigs and not turns


_TINTED = {
    "tone": ("film", "gain", "midtone"), "shadow": ("film", "lift"), "highlight": ("film", "gain"),
    "thing": ("material", "base_color", "tint"), "sky": ("world", "color", "tint"),
    "light": ("lights", "color", "temperature"),
}  # fmt: skip
"""Kind of a target -> the owner of the parameters that move it toward a color, then the names of these parameters."""
_ALIKE = 0.87  # least cosine of the angle between two hues that count as one: 30 degrees
_GRAYISH = 0.03  # OKLab chroma below which a color has no hue
_MIXED = {1.0: 0.2, 2.0: 0.4, 4.0: 0.75}
"""`_steps` of a color word -> share of the way to move to its color ("redder"), or of it to remove ("less red")."""


def _recolored(attribute: Attribute, vocabulary: Vocabulary, scene: SceneDescription, factor: float) -> Iterator[Wish]:
    """Yields the wish of a comparative color: "redder" moves the present color toward red, "less pink" removes pink.

    If the present color is unknown, the tint of the object, sky or image moves that way. `factor`: as for `further`.
    """
    assert attribute.color
    steps = _steps(attribute.word)
    share = abs(1.0 - factor) if factor else _MIXED[steps]
    present = _color_of(attribute, scene)
    if present is not None:
        color = (
            _toned_down(present, attribute.color, share) if attribute.less else _mixed(present, attribute.color, share)
        )
        yield from wishes_of([replace(attribute, color=color, strength=1.0)], vocabulary)
    else:
        stops = 2.0 * abs(math.log2(factor)) if factor else steps
        yield from _tinted(attribute, -stops if attribute.less else stops)


def _tinted(attribute: Attribute, steps: float) -> Iterator[Wish]:
    """Yields the wish that a tint moves by `steps` toward the color of a word (away if below 0); none for a gray."""
    assert attribute.color
    _, a, b = oklab_from_srgb(attribute.color)
    if math.hypot(a, b) < _GRAYISH:
        return
    lights = attribute.lights or attribute.role
    kind = "thing" if attribute.owners else "light" if lights else attribute.kind
    ends = tuple(sorted((_LEAST * _NOTICED * steps, _MOST * _NOTICED * steps)))
    part = kind if kind in ("thing", "sky") else "picture"
    tint = ClaimText(part, "tint", ends[:1], ends[1:], color=hex_from_srgb(attribute.color), by=True)
    owner, *names = _TINTED.get(kind, _TINTED["tone"])
    reach = _REACH * abs(steps)
    effects = tuple(Effect(owner, name, "near", (-reach,), (reach,), priority=1) for name in names)
    bound = replace(attribute, entry="", color=None, strength=1.0)
    if part == "picture" and not lights:
        bound = replace(bound, slot="grade", kind="tone", region="whole")
    quantity = "color" if kind == "thing" else "light_color" if lights else "cast"
    yield Wish(bound, quantity, effects=effects, claims=(tint,))


def _color_of(attribute: Attribute, scene: SceneDescription) -> Values | None:
    """Present color, sRGB, of the largest material that a word describes; None if it is unknown.

    A word that names no object describes the subject, if the subject's color has about the word's hue; else None.
    """
    materials = attribute.owners or [
        n for n, region in scene.materials.items() if region == attribute.region == "subject"
    ]
    looks = [scene.looks[name] for name in materials if name in scene.looks]
    color = max(looks, key=lambda look: look.share).color if looks else None
    if color is None or attribute.owners:
        return color
    (_, *first), (_, *other) = oklab_from_srgb(color), oklab_from_srgb(attribute.color or color)
    lengths = math.hypot(*first), math.hypot(*other)
    cosine = sum(x * y for x, y in zip(first, other, strict=True)) / max(lengths[0] * lengths[1], 1e-9)
    return color if min(lengths) > _GRAYISH and cosine > _ALIKE else None


def _mixed(present: Values, named: Values, share: float) -> Values:
    rows = zip(oklab_from_srgb(present), oklab_from_srgb(named), (0.5 * share, share, share), strict=True)
    light, a, b = (v + part * (w - v) for v, w, part in rows)
    return srgb_from_oklab((light, a, b))


def _toned_down(present: Values, named: Values, share: float) -> Values:
    """`present` without `share` of its chroma along the hue of `named` in OKLab; all colors are sRGB."""
    light, a, b = oklab_from_srgb(present)
    _, x, y = oklab_from_srgb(named)
    along = max(a * x + b * y, 0.0) / max(x * x + y * y, 1e-9)
    if along * math.hypot(x, y) > _ALIKE * math.hypot(a, b):
        return srgb_from_oklab((light, (1.0 - share) * a, (1.0 - share) * b))
    return srgb_from_oklab((light, a - share * along * x, b - share * along * y))


def _names_light_of(attribute: Attribute, compared: Attribute) -> bool:
    """True if `attribute` only names the light that `compared` changes: "window light" in "the window light darker"."""
    same = bool(attribute.lights) and {*attribute.lights} <= {*compared.lights}
    return attribute.slot == "lighting" and (same or bool(attribute.role and attribute.role == compared.role))


def _beside(claim: ClaimText) -> ClaimText:
    """The claim, now for a change of 1 to 2.5 noticeable steps in its direction; unchanged if it names no change."""
    ends = (1.0, 2.5) if (claim.change or 0.0) > 0.0 else (-2.5, -1.0)
    return replace(claim, lower=ends[:1], upper=ends[1:], change=None, by=True) if claim.change else claim


def _compared(attribute: Attribute, vocabulary: Vocabulary, factor: float, noun: Attribute | None) -> Iterator[Wish]:
    """Yields at most one wish of a comparative word: to change one measure or, if nothing measures it, the parameters.

    Args:
        factor: As for `further`.
        noun: The noun that the word describes, if that is a look word: "fog thinner" asks for less than "fog".
    """
    plain = wishes_of([replace(attribute, strength=1.0)], vocabulary)
    main = next((wish for wish in plain if wish.claims), next((wish for wish in plain if wish.effects), None))
    if main is None:
        return
    # Effects that belong to the main wish. Other wishes with a class or claims of their own are left out, and so are
    # weak effects.
    others = (w for w in plain if not (w is main or w.named or w.claims))
    effects = (*main.effects, *(e for wish in others for e in wish.effects if not e.weak))
    falls = attribute.less != (noun is not None and _is_less_than(main, noun, vocabulary))
    way = _steps(attribute.word) * (-1.0 if falls else 1.0)
    if factor and main.quantity in _NO_AMOUNTS:  # nobody can say what half the warmth is: as many steps as stops
        way, factor = math.copysign(2.0 * abs(math.log2(factor)), way), 0.0
    claims: tuple[ClaimText, ...] = ()
    if main.claims and not factor:
        claim = main.claims[-1]
        rises = claim.change > 0.0 if claim.change else claim.lower[0] > -math.inf
        noticed = _NOTICED * (way if rises else -way)
        lower, upper = sorted((_LEAST * noticed, _MOST * noticed))
        claims = (replace(claim, lower=(lower,), upper=(upper,), change=None, near=True, by=True),)
        if claim.measure == "light_up":  # a lower sun stays on its side
            effects = tuple(effect for effect in effects if effect.name != "azimuth")
        moved = [_around(effect, noticed, way) for effect in effects]
    else:
        moved = [_effect_moved(e, way, factor) for e in effects if FAMILIES[e.family].components == 1]
    # Without an entry the word stands for no rig: it is about the light that is in the scene.
    bound = replace(attribute, entry="", strength=1.0, shades=(), phrases=())
    yield Wish(bound, main.quantity, effects=tuple(dict.fromkeys(moved)), claims=claims)


def _around(effect: Effect, noticed: float, way: float) -> Effect:
    """An effect that lets the parameter of `effect` move around its present value, by `_REACH` for each step.

    Sizes of lights and finishes move only in the direction of the word, which is `way` steps of `noticed` in the measure.
    """
    of_size = effect.name in ("size", "angle")
    reach = (3.0 if of_size else 1.0) * _REACH * abs(noticed) / _NOTICED  # shadows soften slowly
    larger = sum(effect.lower + effect.upper) > 2.0 * FAMILIES[effect.family].default
    towards = way * ((1.0 if larger else -1.0) if of_size else _finish_direction(effect))
    down, up = (0.0 if towards > 0.0 else reach), (0.0 if towards < 0.0 else reach)
    return Effect(effect.owner, effect.name, "near", (-down,), (up,), priority=1)


def _finish_direction(effect: Effect) -> float:
    """1 if an effect raises a material's value from its default, -1 if it lowers it; 0 for all other effects."""
    parameter = FAMILIES[effect.family]
    if parameter.group != "material" or parameter.components > 1 or effect.mode:
        return 0.0
    low, plain, high = effect.lower[0], parameter.default, effect.upper[0]
    if low < plain < high:
        return 0.0
    # A range that begins at the parameter's own lower end, as "coat 0..0.1" does, asks for less.
    rises = high == parameter.upper if plain >= high else low > parameter.lower
    return 1.0 if rises else -1.0


def _effect_moved(effect: Effect, way: float, factor: float) -> Effect:
    """`effect`, changed to multiply its parameter by `factor` or, if that is 0, to move it by `way` of its steps."""
    parameter = FAMILIES[effect.family]
    if not factor:
        rises = effect.mode == "times" and effect.lower[0] * effect.upper[0] > 1.0
        if effect.mode != "times" and effect.lower:
            rises = effect.lower[0] + effect.upper[0] > 2 * parameter.default
        way = way if rises else -way
        if parameter.scale.name != "log":
            ends = sorted((_REACH * way * (1 - _EXACT), _REACH * way * (1 + _EXACT)))
            return Effect(effect.owner, effect.name, "near", (ends[0],), (ends[1],), priority=1)
        factor = (_WARMER if effect.name == "temperature" else _BRIGHTER) ** way
    low, high = ((factor * (1 + off),) for off in (-_EXACT, _EXACT))
    return Effect(effect.owner, effect.name, "times", low, high, priority=1)


def _steps(word: str) -> float:
    """Steps that a word asks for: 1 for "a bit warmer", 2 for "warmer", 4 for "much warmer"."""
    return 1.0 if _SMALL.search(word) else 4.0 if _LARGE.search(word) else 2.0


def _is_less_than(wish: Wish, noun: Attribute, vocabulary: Vocabulary) -> bool:
    """True if a wish asks for lower parameter values than `noun` alone; False if they have no parameter in common."""
    plain = {e.family: e for each in wishes_of([noun], vocabulary) for e in each.effects if not e.weak}
    pairs = [(e, plain[e.family]) for e in wish.effects if e.family in plain]
    return bool(pairs) and all(sum(e.lower + e.upper) < sum(p.lower + p.upper) for e, p in pairs)
