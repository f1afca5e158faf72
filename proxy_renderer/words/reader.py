# SPDX-License-Identifier: Apache-2.0
"""Binds the look words of a prompt by fitted weights, and says what they are bound to in the planner's terms."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from ..schema import VibeError
from ..schema.parameters import Region
from .attributes import LightPhrases, NamedThing, light_phrases, shaded
from .features import looks, reading
from .lexicon.rigs import TIMES, rig_table
from .lexicon.vocabulary import Vocabulary
from .model import likeliest_row, probabilities, scores, shipped_weights
from .normalizing import KeyedSpan
from .own_nouns import AbsentObjects
from .passage import PromptLook
from .scene import materials_of
from .targets import LAMPS, MATTER, NOWHERE, ROLES, TINGE, Choices, PromptPairs, TargetPair, rest, sense_at
from .types import STRONGEST, WEAKEST, Attribute, Parsed, SceneDescription

_PLAIN = "Use plain look words that the vocabulary knows."
_UNSURE = 0.35
"""Probability that a word is no look from which it is not used; chosen on a half of tests/words/ordinary_words.toml."""
_LESS = 0.7  # share of the opposite that "less" asks for
_KINDS = {"lights": "light", "key": "light", "air": "fog"}
"""Kind of target -> kind of thing, where they differ."""
_OF_SLOT = {"lighting": "light", "atmosphere": "fog", "grade": "tone", "setting": "surroundings"}
"""Slot -> kind of thing that its words are about in an image as a whole."""
_PAINTS = ("color", "material")
"""Slots of which a surface has one each."""


@dataclass(frozen=True)
class Thing:
    """The thing that look words are bound to; `kind` as in the vocabulary's nouns, or "whole"; all as in `types.Attribute`."""

    kind: str
    thing: str
    region: Region
    owners: tuple[str, ...] = ()
    role: str = ""
    lights: tuple[str, ...] = ()


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
    # id of a pair -> its part of the materials, where several looks deal them out
    parts: dict[int, tuple[str, ...]]
    parsed: Parsed  # the result, without what `attributes.complete` adds
    # the nouns with a surface: name, region and materials
    mentioned: list[NamedThing] = field(default_factory=list)
    absent: set[int] = field(default_factory=set)  # numbers of the look words whose object the scene lacks
    unused: set[int] = field(default_factory=set)  # numbers of the look words that are left out
    lacking: list[str] = field(default_factory=list)  # says which words describe objects that the scene lacks

    @property
    def undone(self) -> list[str]:
        """Wishes that values cannot fulfill."""
        return [" ".join(words) for words in self.pairs.passage.wishes]

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
        weights: By fact; None for those that are shipped.
        foreign: Words of another language that are left in the text.
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
    choices = Choices(targets or {}, english or {}, after_keys, scene, vocabulary)
    phrases = light_phrases(pairs.passage, vocabulary, rig_table())
    read = PromptReading(vocabulary, scene, weights, pairs, [], phrases, scene.subject, {}, Parsed(text))
    each = zip(likeliest_row(pairs, weights), pairs.pairs, strict=True)
    read.chosen = choices.bound(_where_it_stands(read, pair, others) for pair, others in each)
    parsed, passage = read.parsed, pairs.passage
    read.subject = _subject_name(read) or scene.subject
    _deal_materials(read)
    _find_absent(read)
    # What each word says
    for number, pair in enumerate(read.chosen):
        said = _attributes_of(read, number, is_part)
        parsed.attributes += [replace(attribute, look=number) for attribute in said or ()]
        if said == []:
            read.unused.add(number)
            parsed.ignored.append(pair.look.text)
        elif said and pair.look.token.guess:
            parsed.guesses[pair.look.token.text] = pair.look.token.guess
    parsed.notes += [f"'{word}' is no look word here: its target is not used." for word in choices.unused()]
    parsed.ignored += [*(w for words in passage.wishes for w in words), *passage.beyond, *_unknown(read)]
    parsed.guesses |= dict(_guessed_names(read))
    return read


def _where_it_stands(read: PromptReading, pair: TargetPair, pairs: list[TargetPair]) -> TargetPair:
    """A word with the target that its place leaves no doubt of.

    A color right before fog or smoke is that of the air: "greenish ground fog". In the description of a light a word is said of
    light unless it tells of something that is named there: "a pink one".
    """
    kind, mention, color = pair.target.kind, pair.target.mention, pair.look.token.color
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
        stays = not (matter and (color or pair.look.token.adjective)) or _is_definite(read, pair.look)
    role = read.phrases.role(pair.look.index)
    if stays and not (role and kind == "light"):
        return pair
    return next((other for other in pairs if other.target.kind == (role or "light")), pair)


def _is_definite(read: PromptReading, look: PromptLook) -> bool:
    """Whether a word that could be a thing is spoken of as one: "the candle is red"."""
    before = read.pairs.passage.items[look.index - 1 : look.index]
    return any(item.text in read.vocabulary.lists["definite"] for item in before)


def _subject_name(read: PromptReading) -> str:
    """The noun by which the prompt calls a subject whose names the scene does not tell: "car" of a scene of cubes."""
    mentions = read.pairs.mentions
    used = {p.look.index for p in read.chosen if p.target.kind not in NOWHERE}
    named = {name for m in mentions for n in m.named if n.kind == "things" for name in n.names}
    words = {item.text for item in read.pairs.passage.items}
    if read.scene.subject in words or not named.isdisjoint(materials_of("subject", read.scene)):
        return ""
    starts = {m.start for m in mentions}
    unknown = (
        m for m in mentions if m.noun in ("unknown", "subject") and not m.named and not m.text[0].isdigit()
    )
    mine = (m for m in unknown if m.end + 1 not in starts)
    return next((m.text for m in mine if not any(m.covers(index) for index in used)), "")


def _deal_materials(read: PromptReading) -> None:
    """Deals the materials of one noun out to its colors: "red, green and blue balls"; a note says so.

    The first color gets the material of the largest object, and so on in turn.
    """
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


def _find_absent(read: PromptReading) -> None:
    """Finds the words whose object the scene lacks; the notes get a sentence for each object."""
    objects, lacking = AbsentObjects(read.pairs, read.scene, read.vocabulary), defaultdict(list)
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
    look, kind, lights = pair.look, pair.target.kind, read.light_numbers(pair.look)
    if pair.chosen:
        if kind == "none":
            return []
        thing = _thing(read, pair)
        thing = replace(thing, thing=pair.chosen) if pair.target.names else thing
        return [*_attributes(read, look, _entry(pair, []), thing, (), is_part)]
    # a pier where there is one
    is_a_name = any(m.named and m.covers(look.index) for m in read.pairs.mentions)
    unsure = _is_unsure(read, pair, read.pairs.pairs[number])
    if look.index in read.phrases.gone and kind not in MATTER:  # "replace the harsh lamp"
        return []
    if kind == "light" and is_a_name and _is_described(read, look):  # the fire of "blue fire"
        return None
    if (kind == "none" or unsure) and not is_a_name and _is_a_light(read, look):
        thing = Thing("light", look.token.text, "whole")  # a source of light, said of light as a whole
        return [
            Attribute(
                look.text,
                look.token.entry,
                "lighting",
                strength=look.strength,
                negated=look.negated,
                phrases=lights,
                **vars(thing),
            )
        ]
    if number in read.absent or unsure:
        return []
    if kind in NOWHERE:
        return None if kind == TINGE or is_a_name else []
    entry = _entry(pair, read.chosen[number + 1 : number + 2])
    said = [*_attributes(read, look, entry, _thing(read, pair), lights, is_part)]
    before = read.chosen[number - 1] if number else pair
    if before.target.kind != TINGE:
        return said
    alone = sense_at(before.look.token, "things", read.vocabulary)  # the shade that the word before says
    shade = alone.entry if alone else ""
    return [shaded(each, before.look.text, shade, before.look.strength, read.vocabulary) for each in said]


def _is_unsure(read: PromptReading, pair: TargetPair, pairs: Sequence[TargetPair]) -> bool:
    """Whether a word may as well be none that speaks of a look, and no noun says what it describes."""
    if pair.target.mention >= 0 or pair.target.kind not in (*MATTER, "picture") or len(read.chosen) == 1:
        return False
    likely = zip(scores(pairs, read.weights), pairs, strict=True)
    return sum(math.exp(score) for score, each in likely if each.target.kind == "none") > _UNSURE


def _is_described(read: PromptReading, look: PromptLook) -> bool:
    """True if a word is the object that other words describe."""
    others = (pair for pair in read.chosen if pair.look is not look and pair.target.kind != "none")
    return any(look.token.text in _name(read, pair).split() for pair in others)


def _is_a_light(read: PromptReading, look: PromptLook) -> bool:
    """Whether a word that seems to name a thing is a source of light that a rig is for: "a single candle on the left"."""
    rig = rig_table().rigs.get(look.token.entry)
    if rig is None or rig.kind not in ("source", *TIMES) or rig.adds or look.token.guess:
        return False
    if _is_definite(read, look) and "thing" in look.token.lists:
        return False
    return not _is_described(read, look)


def _entry(pair: TargetPair, after: list[TargetPair]) -> str:
    """The entry of a look word; of "emerald velvet" the emerald is the color of the next material."""
    token, sense = pair.look.token, pair.sense
    own = token.name or token.text
    if after and token.color and sense.slot == after[0].sense.slot == "material":
        return own if after[0].look.index == pair.look.index + 1 else sense.entry
    return sense.entry or own


def _attributes(
    read: PromptReading, word: PromptLook, entry: str, thing: Thing, lights: tuple[int, ...], is_part: bool
) -> Iterator[Attribute]:
    """The attributes that a look word gives a thing; a mood brings those of its meaning, each read without a scene."""
    known = read.vocabulary.entries.get(entry)
    if known and word.less and known.opposite and known.slot != "atmosphere":  # less fog is still fog
        entry, word = known.opposite, replace(word, strength=_LESS)
        known = read.vocabulary.entries[entry]
    yield Attribute(
        word=word.text,
        entry=entry,
        slot=known.slot if known else "color",
        strength=word.strength,
        negated=word.negated,
        color=None if known else word.token.color,
        guess=bool(word.token.guess),
        shades=word.token.shades if known else (),
        phrases=lights,
        **vars(thing),
    )
    if not known or not known.means or word.negated:
        return
    if is_part:
        raise VibeError(f"Vocabulary: '{known.name}', for which a mood stands, is a mood itself.", _PLAIN)
    for text in known.means.split(","):
        parts = read_words(
            text, SceneDescription(), read.vocabulary, read.weights, is_part=True
        ).parsed.attributes
        if not parts:
            raise VibeError(
                f"Vocabulary: '{text.strip()}', for which '{known.name}' stands, is no look.", _PLAIN
            )
        for part in parts:
            strength = min(max(part.strength * word.strength, WEAKEST), STRONGEST)
            guess = bool(word.token.guess)
            yield replace(part, cause=word.text, strength=strength, guess=guess, phrases=())


def _name(read: PromptReading, pair: TargetPair) -> str:
    """The name that the prompt gives what a pair binds its look word to."""
    kind = pair.target.kind
    if pair.target.mention >= 0:
        return read.pairs.mentions[pair.target.mention].text
    if kind == "subject":
        return read.subject or "subject"
    return kind if kind in MATTER else pair.look.token.text


def _thing(read: PromptReading, pair: TargetPair) -> Thing:
    """The thing that a pair binds its look word to; one with a surface is mentioned."""
    target, scene, slot = pair.target, read.scene, pair.sense.slot
    kind, word, name = target.kind, pair.look.token.text, _name(read, pair)
    if kind in MATTER:
        return _matter(read, pair, name)
    if kind == "picture":  # the image, or what a word about many things is about in the first place
        if slot == "color":
            return Thing("tone", name, "whole") if target.mention >= 0 else Thing("ambience", "tint", "whole")
        if pair.sense.way == "row":
            return Thing("tone", word, "whole")
        about = _OF_SLOT.get(slot, "whole")
        return Thing(about, word, "surroundings" if about == "surroundings" else "whole")
    apart = kind == "lights" and target.names != {*scene.lights}  # all lights are light as a whole
    return Thing(
        _KINDS.get(kind, kind),
        name,
        "surroundings" if kind == "sky" else "whole",
        role=kind if kind in ROLES else "",
        lights=tuple(sorted(target.names)) if apart else (),
    )


def _matter(read: PromptReading, pair: TargetPair, name: str) -> Thing:
    """Materials, or a whole region."""
    target, scene = pair.target, read.scene
    names = target.names
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
    return Thing(region, name, region, read.parts.get(id(pair), owners))


def _unknown(read: PromptReading) -> Iterator[str]:
    """Words that name nothing that is known, and are no look either."""
    items, mentions = read.pairs.passage.items, read.pairs.mentions
    bound = {pair.look.index for pair in read.chosen if pair.target.kind != "none"}
    unknown = (m for m in mentions if m.noun == "unknown" and not m.named)
    named = {m.text for m in mentions if m.named}
    yield from (m.text for m in unknown if m.start not in bound and m.text != read.subject)
    yield from (t.text for t in items if t.unsure and not t.scene and t.text not in named)
    yield from (t.text for t in items if "count" in t.lists or t.text.isdigit())


def _guessed_names(read: PromptReading) -> Iterable[tuple[str, str]]:
    """Words that are the name of a thing of the scene with a mistake."""
    for mention in read.pairs.mentions:
        named = next((n for n in mention.named if "object misspelled" in n.signs), None)
        if named and mention.members == 1:
            worn = read.scene.object_materials.items()
            yield mention.text, next(name for name, mats in worn if not named.names.isdisjoint(mats))
