# SPDX-License-Identifier: Apache-2.0
"""The words that captions choose from, class by class; the language's own colors and phrases join them."""

import zlib
from dataclasses import dataclass
from functools import cache

from lab.heads.classes import classes_of
from proxy_renderer.color.shades import basic
from proxy_renderer.words.lexicon.entries import VocabularyEntry
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary

AttributeClasses = dict[str, str]
"""Attribute name → class, for those that a picture shows or a caption mentions."""
GUIDES, JUDGES = 1, 0
"""Salts of the wordings that the guide and the judge learn from."""
_KEPT_BACK = 6
"""One wording in so many is kept from training."""


@dataclass(frozen=True)
class WordingSplit:
    """Which wordings captions choose from: those of training, or those kept back to test with.

    The first of several is a class's plain name, and always trained.

    Attributes:
        salt: Another number keeps other wordings back.
        held_out: Whether to choose from what is kept back.
    """

    salt: int = GUIDES
    held_out: bool = False

    @cache  # noqa: B019 - there are two or three splits in a process
    def own(self, words: tuple[str, ...]) -> tuple[str, ...]:
        """The words that are this split's; a class of few words may keep none of them back."""
        back = {w for w in words[1:] if zlib.crc32(f"{self.salt}:{w}".encode()) % _KEPT_BACK == 0}
        back -= {words[0]}
        return tuple(w for w in words if (w in back) == self.held_out)

    def of(self, words: tuple[str, ...]) -> tuple[str, ...]:
        """The words that this split may use: its own, and all of them where it has none."""
        return self.own(words) or words


TRAINED = WordingSplit()


def _list(words: str) -> tuple[str, ...]:
    return tuple(words.split(", "))


def _table(rows: dict[str, str]) -> dict[str, tuple[str, ...]]:
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
        "matte": "matte, flat matte, dull, chalky, rough, non-reflective, clay-like, rubbery, very matte",
        "satin": "satin, semi-gloss, eggshell, silky, soft-sheen, slightly glossy, slightly shiny",
        "glossy": "glossy, shiny, polished, lacquered, mirror-like, gleaming, reflective, glazed, very glossy, very shiny, mirror finish",
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
        "left": "light from the left, strong left light, lit from the left, key light on the left, left-side lighting, light from upper left, light from the upper left",
        "right": "light from the right, strong right light, lit from the right, key light on the right, right-side lighting, light from upper right, light from the upper right",
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
        "light": "light haze, thin mist, slight fog, hazy, misty, light fog, faint mist, slightly misty, slightly foggy",
        "thick": "thick fog, dense fog, heavy mist, foggy, very foggy, thick haze, very misty",
    }
)
BRIGHTNESS_WORDS = _table(
    {
        "dark": "dark, dim, dark picture, low-key, underexposed, night, gloomy, shadowy, very dark",
        "medium": "medium brightness, normal exposure, balanced exposure, evenly exposed",
        "bright": "bright, high-key, brightly lit, bright picture, airy, luminous, overexposed, very bright",
    }
)
CONTRAST_WORDS = _table(
    {
        "low": "low contrast, flat contrast, faded, washed out, soft contrast, very low contrast",
        "medium": "medium contrast, normal contrast, moderate contrast",
        "high": "high contrast, bold contrast, strong contrast, dramatic contrast, punchy, very high contrast",
    }
)
SATURATION_WORDS = _table(
    {
        "muted": "muted colors, desaturated, muted, washed-out colors, subdued colors, colorless, monochrome, very muted colors",
        "natural": "natural colors, realistic colors, normal saturation, natural saturation",
        "vivid": "vivid colors, vibrant, saturated, vibrant colors, intense colors, highly saturated, very vivid colors",
    }
)
VIGNETTE_WORDS = _table(
    {
        "none": "no vignette, without vignette, even corners",
        "vignette": "vignette, dark corners, strong vignette, vignetted, darkened edges, heavy vignette",
    }
)


@cache
def color_names() -> dict[str, tuple[str, ...]]:
    """Basic color → all names that the language calls by it."""
    names: dict[str, list[str]] = {}
    for name, code in shipped_vocabulary().colors.items():
        if "mist" not in name:  # "misty rose" would speak of fog
            names.setdefault(basic(code), []).append(name)
    return {color: tuple(each) for color, each in names.items()}


@cache
def phrases() -> list[tuple[str, AttributeClasses]]:
    """Text that tells an encoder for a look word, with the attributes that it then asks for.

    Phrases that name a color beside what they ask for ("gray steel") would claim too much.
    """
    colors = {word for words in COLOR_WORDS.values() for word in words}
    return [
        (entry.phrase, classes_of(entry))
        for entry in _asking()
        if "subject_color" in classes_of(entry) or entry.slot != "material" or not colors & {*entry.phrase.split()}
    ]


@cache
def lessons_by_class() -> dict[str, dict[str, list[tuple[str, AttributeClasses]]]]:
    """Text that tells an encoder for look words, with what it then asks for, by attribute and class.

    Under "" is what asks for several attributes.
    """
    by_class: dict[str, dict[str, list[tuple[str, AttributeClasses]]]] = {}
    for entry in _asking():
        (name, value), *more = classes_of(entry).items()
        name, value = ("", "") if more else (name, value)
        by_class.setdefault(name, {}).setdefault(value, []).append((entry.phrase, classes_of(entry)))
    return by_class


def _asking() -> list[VocabularyEntry]:
    """The entries that ask for something which a head reads."""
    return [entry for entry in shipped_vocabulary().entries.values() if classes_of(entry)]
