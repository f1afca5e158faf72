# SPDX-License-Identifier: Apache-2.0
"""Exact captions: only what a picture shows is said, in many wordings, long and short.

A caption mentions some of a picture's attributes. The thing's name says nothing about the look, so
names are drawn at random and the text tower learns to leave them aside.
"""

import random

from lab.heads.attributes import ATTRIBUTES
from lab.train.text.wording import (
    BRIGHTNESS_WORDS,
    COLOR_WORDS,
    CONTRAST_WORDS,
    FINISH_WORDS,
    FOG_WORDS,
    METAL_WORDS,
    NOUNS,
    SATURATION_WORDS,
    SIDE_WORDS,
    SOFT_WORDS,
    TEMPERATURE_WORDS,
    TRAINED,
    VIGNETTE_WORDS,
    AttributeClasses,
    WordingSplit,
    color_names,
    phrases,
)

_PLAIN = {
    "light_side": SIDE_WORDS, "light_softness": SOFT_WORDS, "light_temperature": TEMPERATURE_WORDS, "fog": FOG_WORDS,
    "brightness": BRIGHTNESS_WORDS, "contrast": CONTRAST_WORDS, "saturation": SATURATION_WORDS, "vignette": VIGNETTE_WORDS,
}  # fmt: skip
_TABLES = {
    "subject_color": COLOR_WORDS, "surroundings_color": COLOR_WORDS, "subject_finish": FINISH_WORDS, "subject_metal": METAL_WORDS, **_PLAIN,
}  # fmt: skip
_SYLLABLES = tuple(
    c + v for c in ("b", "d", "f", "g", "k", "l", "m", "n", "p", "r", "s", "t", "v", "z", "st", "ch") for v in "aeiou"
)
_PLACES = (
    "{c} background", "a {c} background", "on a {c} background", "{c} backdrop", "{c} surroundings", "against {c}", "{c} studio",
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


def caption(
    mentioned: AttributeClasses, dice: random.Random, empty: bool = False, split: WordingSplit = TRAINED
) -> str:
    """A sentence that says exactly these attributes.

    Args:
        mentioned: What to say; at least one attribute.
        empty: Whether the picture shows the surroundings only.
    """
    rest = dict(mentioned)
    phrase = _phrase(rest, dice) if dice.random() < (0.0 if split.held_out else 0.3) else ""
    clauses = [] if empty else [_thing(rest, dice, split)]
    clauses.append(phrase)
    clauses += _surroundings(rest, dice, empty, split)
    side = rest.get("light_side")
    if side and {"light_softness", "light_temperature"} & rest.keys() and dice.random() < 0.6:
        words = [
            dice.choice(split.of(_PLAIN[n][rest.pop(n)])).split()[0]
            for n in ("light_temperature", "light_softness")
            if n in rest
        ]
        clauses.append(f"{' '.join(words)} {dice.choice(split.of(SIDE_WORDS[rest.pop('light_side')]))}")
    elif {"light_softness", "light_temperature"} <= rest.keys() and dice.random() < 0.6:
        first = dice.choice(split.of(TEMPERATURE_WORDS[rest.pop("light_temperature")])).split()[0]
        clauses.append(f"{first} {dice.choice(split.of(SOFT_WORDS[rest.pop('light_softness')]))}")
    clauses += [dice.choice(split.of(_PLAIN[name][value])) for name, value in rest.items() if name in _PLAIN]
    clauses = [clause for clause in clauses if clause]
    if len(clauses) > 1 and dice.random() < 0.35:
        dice.shuffle(clauses)
    return dice.choice((", ", ", ", ", ", " with ", ". ", " ")).join(clauses) + dice.choice(("", "", "."))


def sayable(mentioned: AttributeClasses, split: WordingSplit) -> bool:
    """True if a split has words of its own for all of these classes."""
    lists = [_TABLES[name][value] for name, value in mentioned.items()]
    lists += [color_names()[value] for name, value in mentioned.items() if _TABLES[name] is COLOR_WORDS]
    return all(map(split.own, lists))


def _phrase(rest: AttributeClasses, dice: random.Random) -> str:
    """One of the language's own phrases that fits, or nothing; takes from ``rest`` what it says."""
    fitting = [(phrase, asks) for phrase, asks in phrases() if asks.items() <= rest.items()]
    if not fitting:
        return ""
    phrase, asks = dice.choice(fitting)
    for name in asks:
        del rest[name]
    return phrase


def _color(name: str, dice: random.Random, split: WordingSplit) -> str:
    return dice.choice(split.of(COLOR_WORDS[name] if dice.random() < 0.75 else color_names()[name]))


def _noun(dice: random.Random) -> str:
    """A name of a thing, now and then one that nobody knows: names say nothing about looks."""
    if dice.random() < 0.1:
        return "".join(dice.choice(_SYLLABLES) for _ in range(dice.randint(1, 4)))
    return dice.choice(NOUNS) if dice.random() < 0.6 else dice.choice(NOUNS[:10])


def _thing(rest: AttributeClasses, dice: random.Random, split: WordingSplit) -> str:
    """The subject with its color, finish and metal; takes from ``rest`` what it says."""
    noun = _noun(dice)
    if rest.get("subject_color") == "black" and rest.get("light_side") == "back" and dice.random() < 0.5:
        rest.pop("subject_color"), rest.pop("light_side")
        return dice.choice((f"{noun} silhouette", f"silhouette of a {noun}", f"dark silhouette of a {noun}"))
    color = _color(rest.pop("subject_color"), dice, split) if "subject_color" in rest else ""
    finish = dice.choice(split.of(FINISH_WORDS[rest.pop("subject_finish")])) if "subject_finish" in rest else ""
    metal = dice.choice(split.of(METAL_WORDS[rest.pop("subject_metal")])) if "subject_metal" in rest else ""
    if not (color or finish or metal) and rest and dice.random() < 0.5:
        return ""
    start = dice.choice(_OPENINGS)
    if metal and dice.random() < 0.3:
        return f"{start}{_words(finish, color, noun)} made of {metal}"
    if color and dice.random() < 0.12:
        return f"{start}{_words(finish, metal, noun)} in {color}"
    return start + _words(finish, color, metal, noun)


def _surroundings(rest: AttributeClasses, dice: random.Random, empty: bool, split: WordingSplit) -> list[str]:
    """The place with its color, together with the fog where that reads well."""
    if "surroundings_color" not in rest:
        return []
    color = _color(rest.pop("surroundings_color"), dice, split)
    if rest.get("fog") in ("light", "thick") and dice.random() < 0.4:
        amount = {"light": ("light", "thin", "faint"), "thick": ("thick", "dense", "heavy")}[rest.pop("fog")]
        return [f"{dice.choice(amount)} {color} {dice.choice(('fog', 'mist', 'haze'))}"]
    return [dice.choice(_EMPTY_PLACES if empty else _PLACES).format(c=color)]


def _words(*words: str) -> str:
    return " ".join(word for word in words if word)


def mention(classes: AttributeClasses, flipped: str | None, dice: random.Random) -> AttributeClasses:
    """The attributes that a caption says: few or many, nearly always the flipped one.

    What is nothing special, such as no fog, is rarely said.

    Args:
        flipped: The attribute in which it differs from the others of its group; None if there is none.

    Returns:
        A part of `classes`, in the order of `ATTRIBUTES`; empty if there is nothing worth saying.
    """
    dull = {"fog": "none", "brightness": "medium", "contrast": "medium", "saturation": "natural", "vignette": "none"}
    names = [name for name in classes if dull.get(name) != classes[name] or dice.random() < 0.3 or name == flipped]
    if not names:
        return {}
    count = min(len(names), dice.choice((1, 1, 2, 2, 2, 3, 3, 4, 5, 7)))
    chosen = set(dice.sample(names, count))
    if flipped in classes and dice.random() < 0.9:
        chosen.add(flipped)
    return {name: classes[name] for name in ATTRIBUTES if name in chosen}


def samples(count: int, seed: int, split: WordingSplit = TRAINED) -> list[str]:
    """All words that training will use: captions of random attributes, and every noun, color name and phrase."""
    dice = random.Random(seed)
    drawn = ({name: dice.choice(classes) for name, classes in ATTRIBUTES.items()} for _ in range(count))
    sentences = [
        caption(mention(classes, None, dice) or classes, dice, dice.random() < 0.2, split) for classes in drawn
    ]
    colors = [name for names in color_names().values() for name in split.of(names)]
    return [*sentences, *NOUNS, *colors, *(phrase for phrase, _ in phrases())]
