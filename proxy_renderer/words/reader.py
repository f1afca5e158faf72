# SPDX-License-Identifier: Apache-2.0
"""Binds the look words of a prompt by fitted weights, and says what they are bound to in the planner's terms."""

import math
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from ..schema import VibeError
from ..schema.parameters import Region
from .attributes import LightPhrases, NamedThing, light_phrases, shaded
from .features import looks, reading
from .lexicon.entries import VocabularyEntry
from .lexicon.rigs import TIMES, rig_table
from .lexicon.vocabulary import GLOWING, Vocabulary
from .model import likeliest_row, probabilities, scores, shipped_weights
from .normalizing import KeyedSpan
from .own_nouns import AbsentObjects
from .passage import PromptLook
from .scene import materials_of
from .targets import (
    LAMPS,
    MATTER,
    NOWHERE,
    ROLES,
    TINGE,
    PromptPairs,
    TargetPair,
    rest,
    sense_at,
    with_choices,
)
from .types import STRONGEST, WEAKEST, Attribute, Parsed, SceneDescription

_PLAIN = "Use plain look words that the vocabulary knows."
_UNSURE = 0.35
"""Probability that a word is no look from which it is not used; chosen on a half of tests/words/ordinary_words.toml."""
_LESS = 0.7  # share of the opposite that "less" asks for
_KINDS = {"lights": "light", "key": "light", "air": "fog"}  # of target -> of thing, where they differ
_OF_SLOT = {"lighting": "light", "atmosphere": "fog", "grade": "tone", "setting": "surroundings"}
"""Slot -> kind of thing that its words are about in an image as a whole."""
_PAINTS = ("color", "material")  # slots of which a surface has one each


@dataclass
class PromptReading:
    """A prompt whose look words are bound."""

    vocabulary: Vocabulary
    scene: SceneDescription
    weights: Mapping[str, float]
    pairs: PromptPairs
    chosen: list[TargetPair]  # the pair of each look word
    phrases: LightPhrases  # the lights that the prompt describes one by one
    subject: str  # its name for the subject, or that of the scene
    parts: dict[int, tuple[str, ...]]  # id of a pair -> its materials, where several looks deal them out
    parsed: Parsed  # the result, without what `attributes.complete` adds
    mentioned: list[NamedThing] = field(default_factory=list)  # nouns with a surface
    absent: set[int] = field(default_factory=set)  # numbers of the look words whose object the scene lacks
    unused: set[int] = field(default_factory=set)  # numbers of the look words that are left out
    lacking: list[str] = field(default_factory=list)  # says which words describe objects that the scene lacks

    @cached_property
    def probabilities(self) -> list[list[tuple[TargetPair, float]]]:
        """The likeliest pairs of each look word with their probabilities, whatever the artist says."""
        return probabilities(self.pairs, self.weights)

    def light_numbers(self, look: PromptLook) -> tuple[int, ...]:
        """The numbers of the lights in whose description a word stands."""
        return self.phrases.of.get(look.index, ())


def read_words(
    text: str,
    scene: SceneDescription,
    vocabulary: Vocabulary,
    weights: Mapping[str, float] | None = None,
    *,
    foreign: Collection[str] = (),
    keyed: Collection[KeyedSpan] = (),
    targets: Mapping[str, str] | None = None,
    english: Mapping[str, str] | None = None,
    is_part: bool = False,
) -> PromptReading:
    """Scores every look word with everything that it may describe, and takes the likeliest row of all.

    Args:
        keyed: Passages that are said of something set before them with a colon.
        targets: Word -> the target that the artist has chosen for it.
        english: Word -> the same in English, where the artist's prompt is in another language.
        is_part: Whether the text is the meaning of a mood, which has no mood in it.

    Raises:
        VibeError: The scene has nothing of a name that was chosen.
    """
    weights = shipped_weights() if weights is None else weights
    pairs = reading(text, scene, vocabulary, foreign)
    # The targets that the artist has chosen, also by "Cup: copper"
    after_keys: dict[int, str] = {}
    for name, *ends in keyed:
        first, last = (len(looks(text[:end], scene, vocabulary, foreign).looks) for end in ends)
        after_keys |= dict.fromkeys(range(first, last), name)
    phrases = light_phrases(pairs.passage, vocabulary, rig_table())
    read = PromptReading(vocabulary, scene, weights, pairs, [], phrases, scene.subject, {}, Parsed(text))
    each = zip(likeliest_row(pairs, weights), pairs.pairs, strict=True)
    row = [_where_it_stands(read, pair, others) for pair, others in each]
    read.chosen, unused = with_choices(row, targets or {}, english or {}, after_keys, scene, vocabulary)
    parsed, passage = read.parsed, pairs.passage
    objects = AbsentObjects(pairs, scene, vocabulary)
    read.subject = objects.subject or scene.subject
    _deal_materials(read)
    _find_absent(read, objects)
    # What each word says
    for number, pair in enumerate(read.chosen):
        said = _attributes_of(read, number, is_part)
        lights = () if pair.chosen else read.light_numbers(pair.look)
        parsed.attributes += [
            replace(each, look=number, phrases=() if each.cause else lights) for each in said or ()
        ]
        if said == []:
            read.unused.add(number)
            parsed.ignored.append(pair.look.text)
        elif said and pair.look.token.guess:
            parsed.guesses[pair.look.token.text] = pair.look.token.guess
    parsed.notes += [f"'{word}' is no look word here: its target is not used." for word in unused]
    parsed.ignored += [*(w for words in passage.wishes for w in words), *passage.beyond, *_unknown(read)]
    parsed.guesses |= {item.text: item.guess for item in passage.items if item.scene and item.guess}
    return read


def _where_it_stands(read: PromptReading, pair: TargetPair, pairs: list[TargetPair]) -> TargetPair:
    """A word with the target that its place leaves no doubt of.

    A color right before fog or smoke is that of the air: "greenish ground fog". In the description of a light a word is said of
    light unless it tells of something that is named there: "a pink one". A sun is no lamp, whatever the lamp is called: "sun through
    the window".
    """
    kind, mention, color = pair.target.kind, pair.target.mention, pair.look.token.color
    if kind in LAMPS and _is_a_sun(pair.sense.entry):
        known = (read.scene.lights.get(name) for name in pair.target.names)
        if not any(light and light.type in ("SUN", "") for light in known):
            return next((other for other in pairs if other.target.kind == "light"), pair)
    if not read.light_numbers(pair.look):
        items, place = read.pairs.passage.items, pair.look.index
        after = next((item for item in items[place + 1 :] if item.strength is None), None)
        if not color or after is None or after.clause != items[place].clause:
            return pair
        of_air = after.noun == "fog" or read.vocabulary.slot(after.entry) == "atmosphere"
        return next((other for other in pairs if of_air and other.target.kind == "air"), pair)
    if mention >= 0:
        noun = read.pairs.mentions[mention]
        here = read.phrases.of.get(noun.start) == read.light_numbers(pair.look)
        # "a pink one at the left"
        side = here and any(word in read.vocabulary.picks for word in noun.text.split())
        stays = here if kind in LAMPS else not side
    else:
        matter = kind in MATTER or (kind == "picture" and color)
        stays = not (matter and (color or pair.look.token.adjective))
    role = read.phrases.role(pair.look.index)
    if stays and not (role and kind == "light"):
        return pair
    return next((other for other in pairs if other.target.kind == (role or "light")), pair)


def _is_a_sun(entry: str) -> bool:
    """Whether an entry stands for a rig whose key is a sun."""
    rig = rig_table().rigs.get(entry)
    return rig is not None and any(light.type == "SUN" for light in rig.lights[:1])


def _deal_materials(read: PromptReading) -> None:
    """Deals a noun's materials out to its colors, the largest object's first: "red, green and blue balls"; a note says so."""
    described: dict[int, list[list[TargetPair]]] = defaultdict(list)
    for pair in read.chosen:
        if pair.target.kind == "things" and "several" in pair.target.signs and pair.sense.slot in _PAINTS:
            looks = described[pair.target.mention]
            if looks and read.pairs.passage.adjoin(looks[-1][-1].look, pair.look):  # "walnut brown"
                looks[-1].append(pair)
            else:
                looks.append([pair])
    for looks in described.values():
        materials = _by_size(looks[0][0].target.names, read.scene)
        if 1 < len(looks) <= len(materials):
            each = []
            for number, look in enumerate(looks):
                names = tuple(materials[number :: len(looks)])
                read.parts |= {id(pair): names for pair in look}
                each.append(f"'{' '.join(pair.look.text for pair in look)}' is {', '.join(names)}")
            read.parsed.notes.append(f"Shared out among materials, the largest first: {'; '.join(each)}.")


def _by_size(names: frozenset[str], scene: SceneDescription) -> list[str]:
    """Materials, those of the largest things first."""
    sizes = dict.fromkeys((n for n in scene.materials if n in names), 0.0)
    for wearer, worn in scene.object_materials.items():
        for name in sizes.keys() & {*worn}:
            sizes[name] += scene.places[wearer][2] ** 2 if wearer in scene.places else 0.0
    return sorted(sizes, key=lambda name: -sizes[name])


def _find_absent(read: PromptReading, objects: AbsentObjects) -> None:
    """Finds the words whose object the scene lacks; the notes get a sentence for each object."""
    lacking = defaultdict(list)
    for number, pair in enumerate(read.chosen):
        if noun := "" if pair.chosen else objects.noun_of(pair):
            lacking[noun].append(pair.look.text)
        if noun or objects.is_astray(pair):
            read.absent.add(number)
    for noun, texts in lacking.items():
        words = ", ".join(f"'{text}'" for text in texts)
        read.lacking.append(f"{words}: there is no '{noun}' in the scene; not used.")
    read.parsed.notes += read.lacking


def _attributes_of(read: PromptReading, number: int, is_part: bool) -> list[Attribute] | None:
    """The attributes of a look word; none where it is not used, None where it is part of another word or of a name."""
    pair = read.chosen[number]
    if pair.chosen:
        if pair.target.kind == "none":
            return []
        thing = _thing(read, pair)
        thing = replace(thing, thing=pair.chosen) if pair.target.names else thing
        return [*_attributes(read, pair, pair.sense.entry, thing, is_part)]
    # a pier where there is one
    is_a_name = any(m.named and m.covers(pair.look.index) for m in read.pairs.mentions)
    unsure = _is_unsure(read, number)
    if pair.look.index in read.phrases.gone and pair.target.kind not in MATTER:  # "replace the harsh lamp"
        return []
    if pair.target.kind == "light" and is_a_name and _is_described(read, pair):  # the fire of "blue fire"
        return None
    if (pair.target.kind == "none" or unsure) and not is_a_name and _is_a_light(read, pair):
        entry = pair.look.token.entry  # a source of light, said of light as a whole
        return [*_attributes(read, pair, entry, _of("light", pair.look.token.text, "whole"), is_part)]
    if number in read.absent or unsure:
        return []
    if pair.target.kind in NOWHERE:
        return None if pair.target.kind == TINGE or is_a_name else []
    entry = _entry(pair, read.chosen[max(number - 1, 0) : number], read.chosen[number + 1 : number + 2])
    said = [*_attributes(read, pair, entry, _thing(read, pair), is_part)]
    before = read.chosen[number - 1] if number else pair
    if before.target.kind != TINGE:
        return said
    alone = sense_at(before.look.token, "things", read.vocabulary)  # the shade that the word before says
    shade = alone.entry if alone else ""
    return [shaded(each, before.look.text, shade, before.look.strength, read.vocabulary) for each in said]


def _is_unsure(read: PromptReading, number: int) -> bool:
    """Whether a word may as well be none that speaks of a look, and no noun says what it describes."""
    target, pairs = read.chosen[number].target, read.pairs.pairs[number]
    if target.mention >= 0 or target.kind not in (*MATTER, "picture") or len(read.chosen) == 1:
        return False
    likely = zip(scores(pairs, read.weights), pairs, strict=True)
    return sum(math.exp(score) for score, each in likely if each.target.kind == "none") > _UNSURE


def _is_described(read: PromptReading, pair: TargetPair) -> bool:
    """True if a word is the object that other words describe."""
    described = (p.target.mention for p in read.chosen if p is not pair and p.target.mention >= 0)
    return any(read.pairs.mentions[mention].covers(pair.look.index) for mention in described)


def _is_a_light(read: PromptReading, pair: TargetPair) -> bool:
    """Whether a word that seems to name a thing is a source of light that a rig is for: "a single candle on the left"."""
    token, rig = pair.look.token, rig_table().rigs.get(pair.look.token.entry)
    before = read.pairs.passage.items[pair.look.index - 1 : pair.look.index]
    is_there = any("definite" in item.lists for item in before)  # "the candle is red"
    if is_there or _is_described(read, pair):
        return False
    return rig is not None and rig.kind in ("source", *TIMES) and not (rig.adds or token.guess)


def _entry(pair: TargetPair, before: list[TargetPair], after: list[TargetPair]) -> str:
    """The entry of a look word; "" for a color: the emerald of "emerald velvet", the amber of "glows amber"."""
    if pair.look.token.color and any(b.sense.entry == GLOWING and b.target == pair.target for b in before):
        return ""
    is_color = after and pair.look.token.color and pair.sense.slot == after[0].sense.slot == "material"
    return "" if is_color and after[0].look.index == pair.look.index + 1 else pair.sense.entry


def _attributes(
    read: PromptReading, pair: TargetPair, entry: str, thing: Attribute, is_part: bool
) -> Iterator[Attribute]:
    """The attributes that a look word gives a thing; a mood brings those of its meaning, each read without a scene."""
    word, token = pair.look, pair.look.token
    known = read.vocabulary.entries.get(entry)
    if known and word.less and known.opposite and known.slot != "atmosphere":  # less fog is still fog
        known, word = read.vocabulary.entries[known.opposite], replace(word, strength=_LESS)
    yield replace(
        thing,
        word=word.text,
        entry=known.name if known else token.name or token.text,
        slot=known.slot if known else "color",
        strength=word.strength,
        negated=word.negated,
        color=None if known else token.color,
        guess=bool(token.guess),
        shades=token.shades if known else (),
    )
    if not known or not known.means or word.negated:
        return
    if is_part:
        raise VibeError(f"Vocabulary: '{known.name}', for which a mood stands, is a mood itself.", _PLAIN)
    yield from _meant(read, word, known, thing.kind == "tone")


def _meant(read: PromptReading, word: PromptLook, known: VocabularyEntry, grade: bool) -> Iterator[Attribute]:
    """What a mood stands for; for a grade only what it grades."""
    for text in known.means.split(","):
        meant = read_words(text, SceneDescription(), read.vocabulary, read.weights, is_part=True)
        if not meant.parsed.attributes:
            problem = f"Vocabulary: '{text.strip()}', for which '{known.name}' stands, is no look."
            raise VibeError(problem, _PLAIN)
        for part in (a for a in meant.parsed.attributes if a.slot == "grade" or not grade):
            strength = min(max(part.strength * word.strength, WEAKEST), STRONGEST)
            yield replace(part, cause=word.text, strength=strength, guess=bool(word.token.guess))


def _thing(read: PromptReading, pair: TargetPair) -> Attribute:
    """What a pair binds its look word to, as an attribute without its word; a thing with a surface is mentioned."""
    target, slot, word = pair.target, pair.sense.slot, pair.look.token.text
    kind, is_named = target.kind, target.mention >= 0
    if kind in MATTER:
        return _matter(read, pair)
    name = read.pairs.mentions[target.mention].text if is_named else word
    if kind == "picture":  # the image, or what a word about many things is about in the first place
        if slot == "color":
            return _of("tone", name, "whole") if is_named else _of("ambience", "tint", "whole")
        grade = pair.sense.way == "row" or (slot in ("mood", "setting") and _is_of_a_grade(read, pair))
        about = "tone" if grade else _OF_SLOT.get(slot, "whole")
        return _of(about, word, "surroundings" if about == "surroundings" else "whole")
    region: Region = "surroundings" if kind == "sky" else "whole"
    apart = kind == "lights" and target.names != {*read.scene.lights}  # all lights are light as a whole
    lights = tuple(sorted(target.names)) if apart else ()
    role = kind if kind in ROLES else ""
    return replace(_of(_KINDS.get(kind, kind), name, region), role=role, lights=lights)


def _is_of_a_grade(read: PromptReading, pair: TargetPair) -> bool:
    """Whether a mood is one of the grade alone: "gritty" of "gritty bleach bypass grade"."""
    items, grades = read.pairs.passage.items, read.vocabulary.words["grades"]
    clause = items[pair.look.index].clause
    after = [item for item in items[pair.look.index :] if item.clause == clause]
    head = next((i for i, item in enumerate(after) if item.text in grades), 0)
    return head > 0 and all(item.names_a_look or item.filler for item in after[1:head])


def _of(kind: str, thing: str, region: Region, owners: tuple[str, ...] = ()) -> Attribute:
    return Attribute("", "", "", region, kind, owners=owners, thing=thing)


def _matter(read: PromptReading, pair: TargetPair) -> Attribute:
    """Materials, or a whole region."""
    target, scene, names = pair.target, read.scene, pair.target.names
    own_name = (read.subject or "subject") if target.kind == "subject" else target.kind
    name = read.pairs.mentions[target.mention].text if target.mention >= 0 else own_name
    if target.kind == "others":
        targets = (p.target for p in read.chosen)
        each = (t.names if t.kind == "things" else materials_of(t.kind, scene) for t in targets)
        names = rest(read.pairs.mentions, scene, frozenset().union(*each))
    owners = tuple(n for n in scene.materials if n in names)
    around = target.kind == "surroundings" or {scene.materials[n] for n in owners} == {"surroundings"}
    region: Region = "surroundings" if around else "subject"
    # "background" that is the only wall of a scene, or "the rest" that is all walls, is all that lies around, the sky too
    by_kind = target.kind == "others" or any(s.endswith("synonym") for s in target.signs)
    if pair.sense.slot == "setting" or (by_kind and {*owners} == materials_of("surroundings", scene)):
        region, owners = "surroundings", ()
    read.mentioned.append((name, region, owners))
    return _of(region, name, region, read.parts.get(id(pair), owners))


def _unknown(read: PromptReading) -> Iterator[str]:
    """Words that name nothing that is known, and are no look either."""
    items, mentions = read.pairs.passage.items, read.pairs.mentions
    bound = {pair.look.index for pair in read.chosen if pair.target.kind != "none"}
    unknown = (m for m in mentions if m.noun == "unknown" and not m.named)
    named = {m.text for m in mentions if m.named}
    yield from (m.text for m in unknown if m.start not in bound and m.text != read.subject)
    yield from (t.text for t in items if t.unsure and not t.scene and t.text not in named)
    yield from (t.text for t in items if "count" in t.lists or t.text.isdigit())
