# SPDX-License-Identifier: Apache-2.0
"""Short captions for the encoder, one region each, and what each region must not look like (paper, 3.5).

Contrastive encoders mix up attributes of two things in one sentence, and do not understand "no". So each region has
a caption of its own, negatives are positive descriptions of the mistake, and negated words are left out.
"""

from __future__ import annotations

from .colors import color_class
from .lexicon.entries import VocabularyEntry
from .lexicon.user_words import default_vocabulary
from .lexicon.vocabulary import Vocabulary
from .types import Attribute, Parsed, Prompts

_ORDER = ("mood", "finish", "color", "material")
_MOST = 5  # words per caption: short ones are understood better


def compose(parsed: Parsed, vocabulary: Vocabulary | None = None) -> Prompts:
    """Captions and negatives of a parsed prompt."""
    vocabulary = vocabulary or default_vocabulary()
    meant = [a for a in parsed.attributes if a not in parsed.overruled]
    said = [a for a in meant if not a.negated and not a.cause]
    subject = next((o.name for o in parsed.objects if o.region == "subject"), "subject")
    noun = "object" if subject == "subject" else subject
    around = next((o.name for o in parsed.objects if o.region == "surroundings"), "surroundings")
    backdrop = "background" if around in ("surroundings", "") else around
    mine = _of_region(said, "subject")
    theirs = _of_region(said, "surroundings")
    whole = [a for a in said if a.region == "whole" or a.slot in ("lighting", "atmosphere", "grade", "mood")]
    foreground = ", ".join(_caption(own, name, vocabulary) for name, own in _by_thing(mine, noun).items())
    background = _caption(theirs, backdrop, vocabulary) if theirs else ""
    looks = [_words(a, vocabulary) for a in whole if a not in mine and a not in theirs][:_MOST]
    return Prompts(
        foreground,
        background,
        ", ".join(dict.fromkeys(part for part in (foreground, background, *looks) if part)),
        _negatives(mine, theirs, noun, vocabulary),
        _negatives(theirs, mine, backdrop, vocabulary),
        _unwanted(meant, vocabulary),
    )


def _of_region(attributes: list[Attribute], region: str) -> list[Attribute]:
    """What describes the matter of a region, colors of its fog and sky included."""
    kinds = {"subject": ("subject", "highlight", "glow"), "surroundings": ("surroundings", "sky")}[region]
    bound = [
        a for a in attributes if a.kind in kinds and a.slot in ("color", "finish", "material", "setting")
    ]
    if region == "surroundings":
        bound += [a for a in attributes if a.kind == "fog"]
    else:
        bound += [a for a in attributes if a.entry == "silhouette"]
    return bound


def _by_thing(attributes: list[Attribute], noun: str) -> dict[str, list[Attribute]]:
    """What is said of each thing that has materials of its own: "a white cup, a black table"; of all others together."""
    things: dict[str, list[Attribute]] = {}
    for attribute in attributes:
        things.setdefault(attribute.thing if attribute.owners else noun, []).append(attribute)
    return things or {noun: []}


def _words(attribute: Attribute, vocabulary: Vocabulary) -> str:
    """What the encoder is told for a word: its expansion, with the intensity kept."""
    entry = vocabulary.entries.get(attribute.entry)
    if attribute.color or not entry:
        named = attribute.kind in ("light", "fill", "rim", "shadow", "highlight", "glow", "ambience")
        return f"{attribute.entry} {attribute.thing}" if named else _shade(attribute)
    if attribute.shades:
        return attribute.english or attribute.word
    degree = "slightly " if attribute.strength < 0.8 else "very " if attribute.strength > 1.3 else ""
    return degree + entry.phrase


def _shade(attribute: Attribute) -> str:
    """A color by its name and its kind, "crimson red": encoders know few of the thousand names that colors have."""
    kind, name = color_class(attribute), attribute.entry
    return name if kind in name.replace("gray", "grey") else f"{name} {kind}"


def _caption(attributes: list[Attribute], noun: str, vocabulary: Vocabulary) -> str:
    """ "a glossy teal dolphin": what fits before the noun stands there, longer phrases follow it."""
    before: list[str] = []
    after: list[str] = []
    said = [
        a for a in attributes if a.slot != "setting" or (a.english or a.word) not in noun
    ]  # "a studio studio"
    for attribute in sorted(said, key=lambda a: _ORDER.index(a.slot) if a.slot in _ORDER else 0):
        adjective, _, more = _words(attribute, vocabulary).partition(", ")
        (after if adjective.count(" ") > 1 and not attribute.color else before).append(adjective)
        after += [more] if more else []
        if len(before) + len(after) == _MOST:
            break
    words = " ".join(dict.fromkeys([*before, noun])).split()
    front = " ".join(w for i, w in enumerate(words) if not i or w != words[i - 1])
    article = "an" if front[0] in "aeiou" else "a"
    return ", ".join(dict.fromkeys([f"{article} {front}", *after]))


def _negatives(
    own: list[Attribute], other: list[Attribute], noun: str, vocabulary: Vocabulary
) -> tuple[str, ...]:
    """What must not happen to a region: the other region's colors and matter, and its own words' opposites."""
    mine = {a.entry for a in own}
    entries = (vocabulary.entries.get(a.entry) for a in own)
    meant = {pair for entry in entries if entry for pair in entry.heads.items()}
    swapped = [a for a in other if a.slot in ("color", "material") and a.entry not in mine]
    negatives = [_caption([a], noun, vocabulary) for a in swapped]
    for attribute in (a for a in own if a.slot in ("finish", "material", "color", "setting")):
        opposite = _opposite(attribute, vocabulary)
        if opposite and meant.isdisjoint(opposite.heads.items()):
            negatives.append(f"a {opposite.phrase.partition(',')[0]} {noun}")
    return tuple(dict.fromkeys(negatives))


def _unwanted(attributes: list[Attribute], vocabulary: Vocabulary) -> tuple[str, ...]:
    """For the whole picture: what negated words describe, and the opposites of the others."""
    negatives = []
    for attribute in attributes:
        entry, opposite = vocabulary.entries.get(attribute.entry), _opposite(attribute, vocabulary)
        if attribute.negated and attribute.color:
            negatives.append(_words(attribute, vocabulary))
        elif attribute.negated:
            negatives.append(entry.phrase if entry else attribute.entry)
        elif opposite and attribute.region == "whole" and not attribute.cause:
            negatives.append(opposite.phrase)
    wanted = {_words(a, vocabulary) for a in attributes if not a.negated}
    return tuple(n for n in dict.fromkeys(negatives) if n not in wanted)


def _opposite(attribute: Attribute, vocabulary: Vocabulary) -> VocabularyEntry | None:
    entry = vocabulary.entries.get(attribute.entry)
    return vocabulary.entries.get(entry.opposite) if entry else None
