# SPDX-License-Identifier: Apache-2.0
"""Exact captions: only what a picture shows is said, in many wordings, long and short.

A caption mentions some of a picture's attributes. The thing's name says nothing about the look, so
names are drawn at random and the text tower learns to leave them aside.
"""

import random

from ..language.attributes import ATTRIBUTES

Known = dict[str, str]
"""Attribute name → class, for those that a picture shows or a caption mentions."""


def _list(words: str) -> list[str]:
    return words.split(", ")


def _table(rows: dict[str, str]) -> dict[str, list[str]]:
    """Class → wordings; one that is listed twice is said twice as often."""
    return {name: _list(words) for name, words in rows.items()}


COLOR_WORDS = _table(
    {
        "black": "black, black, black, jet-black, ebony, onyx, charcoal-black, inky",
        "grey": "grey, gray, grey, gray, slate, ash, concrete-grey, stone-grey",
        "white": "white, white, white, ivory, snow-white, off-white, chalk-white, pearl",
        "brown": "brown, brown, chestnut, chocolate, walnut, coffee, umber, tan",
        "red": "red, red, red, crimson, scarlet, ruby, cherry-red, burgundy",
        "orange": "orange, orange, orange, tangerine, amber, pumpkin, rust-orange, apricot",
        "yellow": "yellow, yellow, yellow, lemon, canary, sunflower, mustard, golden-yellow",
        "green": "green, green, green, emerald, lime, jade, olive-green, forest-green",
        "teal": "teal, teal, cyan, turquoise, aqua, blue-green, teal, aquamarine",
        "blue": "blue, blue, blue, navy, azure, cobalt, sapphire, royal-blue",
        "purple": "purple, purple, violet, lavender, plum, indigo, amethyst, mauve",
        "pink": "pink, pink, pink, magenta, rose, fuchsia, salmon-pink, hot-pink",
    }
)
FINISH_WORDS = _table(
    {
        "matte": "matte, flat matte, dull, chalky, rough, non-reflective, clay-like, rubbery",
        "satin": "satin, semi-gloss, eggshell, silky, soft-sheen",
        "glossy": "glossy, shiny, polished, lacquered, mirror-like, gleaming, reflective, glazed",
    }
)
METAL_WORDS = _table(
    {
        "metal": "metal, metallic, steel, chrome, metallic, brushed metal, aluminium",
        "dielectric": "plastic, ceramic, porcelain, painted, non-metallic, clay",
    }
)
NOUNS = _list(
    "object, subject, thing, model, shape, sculpture, figure, form, product, piece, teapot, dolphin, "
    "tree, vase, chair, table, lamp, bottle, car, house, dog, cat, horse, bird, fish, whale, cup, mug, "
    "bowl, jug, pot, kettle, statue, bust, head, toy, robot, ball, sphere, cube, cone, torus, ring, "
    "knot, rock, stone, crystal, gem, boat, ship, plane, bicycle, shoe, hat, bag, box, crate, barrel, "
    "bench, sofa, stool, desk, shelf, clock, camera, phone, guitar, violin, drum, apple, pear, "
    "banana, mushroom, flower, plant, cactus, leaf, branch, pine, castle, tower, bridge, "
    "monument, dragon, bunny, rabbit, bear, elephant, lion, cow, sheep, monkey, armadillo, buddha, "
    "angel, skull, mask, helmet, sword, spoon, fork, plate, pan, candle, book, pillow, cushion, "
    "curtain, door, window, engine, gear, wheel, machine, truck, bus, train, rocket, monster, creature, "
    "animal, person, woman, man, face, hand, scene, still-life"
)
SIDE_WORDS = _table(
    {
        "left": "light from the left, strong left light, lit from the left, key light on the left, left-side lighting, light from upper left",
        "right": "light from the right, strong right light, lit from the right, key light on the right, right-side lighting, light from upper right",
        "front": "frontal light, light from the front, lit from the front, front lighting, light from the camera",
        "back": "backlit, light from behind, back light, rim light from behind, backlighting, lit from behind",
        "top": "light from above, top light, overhead light, lit from above, top-down lighting, noon light",
    }
)
SOFT_WORDS = _table(
    {
        "hard": "hard light, harsh light, hard shadows, sharp shadows, crisp shadows, direct sunlight",
        "soft": "soft light, diffuse light, soft shadows, softbox lighting, gentle light, overcast light",
    }
)
TEMPERATURE_WORDS = _table(
    {
        "warm": "warm light, warm lighting, golden light, golden hour, candlelight, sunset light, warm tones",
        "neutral": "neutral light, white light, neutral lighting, daylight",
        "cool": "cool light, cold light, cool lighting, bluish light, moonlight, cold tones, icy light",
    }
)
FOG_WORDS = _table(
    {
        "none": "no fog, clear air, without fog, clear, no haze, fog-free",
        "light": "light haze, thin mist, slight fog, hazy, light fog, faint mist",
        "thick": "thick fog, dense fog, heavy mist, foggy, misty, very foggy, thick haze",
    }
)
BRIGHTNESS_WORDS = _table(
    {
        "dark": "dark, dim, dark picture, low-key, underexposed, night, gloomy, shadowy",
        "medium": "medium brightness, normal exposure, balanced exposure, evenly exposed",
        "bright": "bright, high-key, brightly lit, bright picture, airy, luminous, overexposed",
    }
)
CONTRAST_WORDS = _table(
    {
        "low": "low contrast, flat contrast, faded, washed out, soft contrast",
        "medium": "medium contrast, normal contrast, moderate contrast",
        "high": "high contrast, bold contrast, strong contrast, dramatic contrast, punchy",
    }
)
SATURATION_WORDS = _table(
    {
        "muted": "muted colors, desaturated, muted, washed-out colors, subdued colors, colorless, monochrome",
        "natural": "natural colors, realistic colors, normal saturation, natural saturation",
        "vivid": "vivid colors, vibrant, saturated, vibrant colors, intense colors, highly saturated",
    }
)
VIGNETTE_WORDS = _table(
    {
        "none": "no vignette, without vignette, even corners",
        "vignette": "vignette, dark corners, strong vignette, vignetted, darkened edges",
    }
)
_PLAIN = {
    "light_side": SIDE_WORDS, "light_softness": SOFT_WORDS, "light_temperature": TEMPERATURE_WORDS, "fog": FOG_WORDS,
    "brightness": BRIGHTNESS_WORDS, "contrast": CONTRAST_WORDS, "saturation": SATURATION_WORDS, "vignette": VIGNETTE_WORDS,
}  # fmt: skip
_PLACES = (
    "{c} background", "{c} background", "on a {c} background", "{c} backdrop", "{c} surroundings", "against {c}", "{c} studio",
    "plain {c} background", "solid {c} background", "{c} studio background", "in front of a {c} wall", "on a {c} floor", "in a {c} void",
)  # fmt: skip
_EMPTY_PLACES = (
    "{c} background",
    "a plain {c} background",
    "{c} backdrop",
    "a {c} studio",
    "{c} surroundings",
    "an empty {c} room",
    "{c} wall",
)
_OPENINGS = (
    "a ",
    "the ",
    "",
    "",
    "",
    "a picture of a ",
    "a render of a ",
    "a photo of a ",
    "a close-up of a ",
    "an isolated ",
)


def caption(mentioned: Known, dice: random.Random, empty: bool = False) -> str:
    """A sentence that says exactly these attributes.

    Args:
        mentioned: What to say; at least one attribute.
        dice: Source of the wording.
        empty: Whether the picture shows the surroundings only.
    """
    rest = dict(mentioned)
    clauses = [] if empty else [_thing(rest, dice)]
    clauses += _surroundings(rest, dice, empty)
    side = rest.get("light_side")
    if side and {"light_softness", "light_temperature"} & rest.keys() and dice.random() < 0.6:
        words = [
            dice.choice(_PLAIN[n][rest.pop(n)]).split()[0]
            for n in ("light_temperature", "light_softness")
            if n in rest
        ]
        clauses.append(f"{' '.join(words)} {dice.choice(SIDE_WORDS[rest.pop('light_side')])}")
    elif {"light_softness", "light_temperature"} <= rest.keys() and dice.random() < 0.6:
        first = dice.choice(TEMPERATURE_WORDS[rest.pop("light_temperature")]).split()[0]
        clauses.append(f"{first} {dice.choice(SOFT_WORDS[rest.pop('light_softness')])}")
    clauses += [dice.choice(_PLAIN[name][value]) for name, value in rest.items() if name in _PLAIN]
    clauses = [clause for clause in clauses if clause]
    if len(clauses) > 1 and dice.random() < 0.35:
        dice.shuffle(clauses)
    return dice.choice((", ", ", ", ", ", " with ", ". ", " ")).join(clauses) + dice.choice(("", "", "."))


def _thing(rest: Known, dice: random.Random) -> str:
    """The subject with its color, finish and metal; takes from ``rest`` what it says."""
    noun = dice.choice(NOUNS) if dice.random() < 0.6 else dice.choice(NOUNS[:10])
    if rest.get("subject_color") == "black" and rest.get("light_side") == "back" and dice.random() < 0.5:
        rest.pop("subject_color"), rest.pop("light_side")
        return dice.choice((f"{noun} silhouette", f"silhouette of a {noun}", f"dark silhouette of a {noun}"))
    color = dice.choice(COLOR_WORDS[rest.pop("subject_color")]) if "subject_color" in rest else ""
    finish = dice.choice(FINISH_WORDS[rest.pop("subject_finish")]) if "subject_finish" in rest else ""
    metal = dice.choice(METAL_WORDS[rest.pop("subject_metal")]) if "subject_metal" in rest else ""
    if not (color or finish or metal) and rest and dice.random() < 0.5:
        return ""
    start = dice.choice(_OPENINGS)
    if metal and dice.random() < 0.3:
        return f"{start}{_words(finish, color, noun)} made of {metal}"
    if color and dice.random() < 0.12:
        return f"{start}{_words(finish, metal, noun)} in {color}"
    return start + _words(finish, color, metal, noun)


def _surroundings(rest: Known, dice: random.Random, empty: bool) -> list[str]:
    """The place with its color, together with the fog where that reads well."""
    if "surroundings_color" not in rest:
        return []
    color = dice.choice(COLOR_WORDS[rest.pop("surroundings_color")])
    if rest.get("fog") in ("light", "thick") and dice.random() < 0.4:
        amount = {"light": ("light", "thin", "faint"), "thick": ("thick", "dense", "heavy")}[rest.pop("fog")]
        return [f"{dice.choice(amount)} {color} {dice.choice(('fog', 'mist', 'haze'))}"]
    return [dice.choice(_EMPTY_PLACES if empty else _PLACES).format(c=color)]


def _words(*words: str) -> str:
    return " ".join(word for word in words if word)


def mention(known: Known, flipped: str | None, dice: random.Random) -> Known:
    """Which of the known attributes a caption says: few or many, nearly always the flipped one."""
    dull = {
        "fog": "none",
        "brightness": "medium",
        "contrast": "medium",
        "saturation": "natural",
        "vignette": "none",
    }
    names = [
        name for name in known if dull.get(name) != known[name] or dice.random() < 0.3 or name == flipped
    ]
    if not names:
        return {}
    count = min(len(names), dice.choice((1, 1, 2, 2, 2, 3, 3, 4, 5, 7)))
    chosen = set(dice.sample(names, count))
    if flipped in known and dice.random() < 0.9:
        chosen.add(flipped)
    return {name: known[name] for name in ATTRIBUTES if name in chosen}


def samples(count: int, seed: int) -> list[str]:
    """Captions of random attributes: the words that training will use."""
    dice = random.Random(seed)
    drawn = ({name: dice.choice(classes) for name, classes in ATTRIBUTES.items()} for _ in range(count))
    return [caption(mention(known, None, dice) or known, dice) for known in drawn]
