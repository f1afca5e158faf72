# SPDX-License-Identifier: Apache-2.0
"""Binds the look words of a prompt by fitted weights, and turns them into attributes for the planner."""

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise

from ..schema import VibeError
from ..schema.parameters import Region
from .attributes import NamedThing, light_phrases
from .lexicon.languages import name_words, singular, thing_words
from .lexicon.rigs import TIMES, rig_table
from .lexicon.vocabulary import Vocabulary
from .mentions import OwnNouns
from .model import likeliest, reading, shipped_weights
from .names import is_detail, is_of_surfaces, parts
from .passage import STRUCTURES
from .scene import NounMention, is_alike, materials_of
from .targets import LAMPS, MATTER, ROLES, SURFACE, PromptPairs, TargetPair, rest, sense_at, with_choices
from .types import GLOW, STRONGEST, WEAKEST, Attribute, MaterialLook, Parsed, SceneDescription

_PLAIN = "Use plain look words that the vocabulary knows."
_MAIN = 0.7  # least share of the subject that has one color, for a subject of one material
_UNSURE = 0.35
"""Probability of being no look word from which a word is unused; chosen on half of tests/words/ordinary_words.toml."""
_RIVAL = 0.6  # least probability of a rival, as a share of that of the likeliest pair
_LARGER = 2.0  # least area of a rival in the image, as a multiple of that of the likeliest pair
_LESS = 0.7  # share of the opposite that "less" asks for
_KINDS = {"lights": "light", "key": "light", "air": "fog"}  # kind of target -> kind of thing, where they differ
_OF_SLOT = {"lighting": "light", "atmosphere": "fog", "grade": "tone", "setting": "surroundings"}
"""Slot -> kind of thing that its words are about in an image as a whole."""


@dataclass
class PromptReading:
    """A prompt whose look words are bound, with all that each of them may describe."""

    vocabulary: Vocabulary
    scene: SceneDescription
    weights: Mapping[str, float]
    pairs: PromptPairs
    chosen: list[TargetPair]  # the pair of each look word
    subject: str  # the prompt's name for the subject, or the scene's
    parsed: Parsed  # the result, without what `attributes.complete` adds
    is_part: bool  # whether the text is the plain wording that a mood stands for
    mentioned: list[NamedThing] = field(default_factory=list)  # nouns with a surface
    absent: set[int] = field(default_factory=set)  # numbers of the look words whose object the scene lacks
    unused: set[int] = field(default_factory=set)  # numbers of the look words that are left out
    # sentences on words that describe objects which the scene lacks
    lacking: list[str] = field(default_factory=list)

    @cached_property
    def probabilities(self) -> list[list[tuple[TargetPair, float]]]:
        """For each look word, its pairs with their probabilities, the likeliest first; ignores the artist's choices."""
        return [likeliest(pairs, self.weights) for pairs in self.pairs.pairs]


def read_words(
    text: str,
    scene: SceneDescription,
    vocabulary: Vocabulary,
    weights: Mapping[str, float] | None = None,
    *,
    foreign: Collection[str] = (),
    targets: Mapping[str, str] | None = None,
    english: Mapping[str, str] | None = None,
    is_part: bool = False,
) -> PromptReading:
    """A prompt with every look word bound to the target that the artist chose for it, else to the likeliest one.

    Args:
        targets: Word -> the target that the artist has chosen for it.
        english: Word -> its English, if the artist's prompt is in another language.
        is_part: Whether the text is the plain wording that a mood stands for; it may have no mood in it.

    Raises:
        VibeError: The scene has nothing with a chosen name, or a word cannot describe its chosen target.
    """
    weights = shipped_weights() if weights is None else weights
    pairs = reading(text, scene, vocabulary, foreign)
    phrases = light_phrases(pairs.passage, vocabulary, rig_table())
    row = _likeliest_pairs(pairs, phrases, scene, vocabulary, weights)
    chosen, unused = with_choices(row, targets or {}, english or {}, scene, vocabulary)
    objects = AbsentObjects(pairs, scene, vocabulary)
    subject, parsed, passage = objects.subject or scene.subject, Parsed(text), pairs.passage
    read = PromptReading(vocabulary, scene, weights, pairs, chosen, subject, parsed, is_part)
    # Words whose object the scene lacks
    lacking = defaultdict(list)
    for number, pair in enumerate(chosen):
        if noun := "" if pair.chosen else objects.noun_of(pair):
            lacking[noun].append(f"'{pair.look.text}'")
            read.absent.add(number)
    texts = lacking.items()
    read.lacking = [f"{', '.join(w)}: there is no '{noun}' in the scene; not used." for noun, w in texts]
    parsed.notes, parsed.absent = [*parsed.notes, *read.lacking], (*lacking,)
    # What each word says
    for number, pair in enumerate(chosen):
        said, token = _attributes_of(read, number), pair.look.token
        lights = () if pair.chosen else phrases.get(pair.look.index, ())
        bound = (replace(each, look=number, phrases=() if each.cause else lights) for each in said or ())
        parsed.attributes += bound
        if said == []:
            read.unused.add(number)
            parsed.ignored.append(pair.look.text)
        elif said and token.guess:
            parsed.guesses[token.text] = token.guess
    parsed.notes += [f"'{word}' is no look word here: its target is not used." for word in unused]
    parsed.ignored += [*(w for words in passage.wishes for w in words), *passage.beyond, *_unknown(read)]
    parsed.guesses |= {item.text: item.guess for item in passage.items if item.scene and item.guess}
    return read


def _likeliest_pairs(
    pairs: PromptPairs,
    phrases: Mapping[int, tuple[int, ...]],
    scene: SceneDescription,
    vocabulary: Vocabulary,
    weights: Mapping[str, float],
) -> list[TargetPair]:
    """The likeliest pair of each look word, corrected where the word describes a light or shares a noun with its neighbor.

    Args:
        phrases: Index of a look word -> numbers of the descriptions of lights that it is in.
    """
    ranked = [_main_first(likeliest(each, weights), pairs, scene) for each in pairs.pairs]
    row = [each[0] for each in ranked]
    if all(pair.target.kind == "none" for pair in row):  # then each word describes something, if it can
        row = [next((p for p in each if p.target.kind != "none"), each[0]) for each in ranked]
    row = [
        _in_its_light(pair, each, pairs.mentions, phrases, vocabulary) for pair, each in zip(row, ranked, strict=True)
    ]
    return _with_neighbors(row, ranked, vocabulary)


def _unknown(read: PromptReading) -> Iterator[str]:
    """Yields the words that are not used: nouns that name nothing known, words that may be looks, and numbers."""
    items, mentions = read.pairs.passage.items, read.pairs.mentions
    bound = {pair.look.index for pair in read.chosen if pair.target.kind != "none"}
    named = {m.text for m in mentions if m.named}
    unknown = (m for m in mentions if m.noun == "unknown" and not m.named and m.start not in bound)
    yield from (m.text for m in unknown if m.text != read.subject)
    yield from (t.text for t in items if t.unsure and not t.scene and t.text not in named)
    yield from (t.text for t in items if "count" in t.lists or t.text.isdigit())


def _main_first(
    ranked: list[tuple[TargetPair, float]], pairs: PromptPairs, scene: SceneDescription
) -> list[TargetPair]:
    """The pairs of one look word, the likeliest first.

    Of two about equally likely materials that one noun names, the larger comes first: a scooter's paint, not its seat.
    """
    first, best = ranked[0]
    found = [pair for pair, _ in ranked]
    if first.target.kind != "things" or first.target.mention < 0:
        return found
    noun = singular(pairs.mentions[first.target.mention].text.split()[-1])

    def area(pair: TargetPair) -> float:
        called_so = all(noun in parts(name) for name in pair.target.names)
        return sum(scene.looks[name].share for name in pair.target.names if called_so and name in scene.looks)

    same = (p for p, share in ranked if share > _RIVAL * best and p.target.mention == first.target.mention)
    main = max((p for p in same if p.target.kind == "things"), key=area)
    if 0.0 < _LARGER * area(first) < area(main):
        found = [main, *(pair for pair in found if pair is not main)]
    return found


def _in_its_light(
    pair: TargetPair,
    pairs: list[TargetPair],
    mentions: list[NounMention],
    phrases: Mapping[int, tuple[int, ...]],
    vocabulary: Vocabulary,
) -> TargetPair:
    """`pair`, or the one of `pairs` for light if its word is in the description of a light: "a pink one at the left".

    A target that the description names stays: the cars of "an orange sun behind the red cars". A word for both lights
    and surfaces ("globes brighter") is about light if the named surface glows.
    """
    source, *rest_of_phrase = pair.look.text.split()
    if pair.target.kind == "lights" and rest_of_phrase and vocabulary.nouns.get(source) == "light":
        # "sun through the window" is no light of the scene that is called after the window
        own = mentions[pair.target.mention].covers(pair.look.index)
        if own and not any(source in parts(name) for name in pair.target.names):
            return next((p for p in pairs if p.target.kind == "light"), pair)
    if pair.target.mention >= 0 and "lamp" in vocabulary.adjectives.get(pair.look.token.adjective, {}):
        same = [p for p in pairs if p.target.kind == "lights" and p.target.mention == pair.target.mention]
        if glow := next((p for p in same if all(name.startswith(GLOW) for name in p.target.names)), None):
            return glow
    target, token, numbers = pair.target, pair.look.token, phrases.get(pair.look.index)
    named_here = target.mention >= 0 and phrases.get(mentions[target.mention].start) == numbers
    is_a_name = any(m.named and m.covers(pair.look.index) for m in mentions)
    may_be = target.kind in LAMPS or (target.kind in MATTER and (token.color or token.adjective))
    if not numbers or named_here or not (may_be or (target.kind == "none" and not is_a_name)):
        return pair
    return next((other for other in pairs if other.target.kind == "light"), pair)


def _with_neighbors(row: list[TargetPair], ranked: list[list[TargetPair]], vocabulary: Vocabulary) -> list[TargetPair]:
    """The pairs of `row`, changed where the next look word tells the target of a color.

    Of two colors that "and" joins, both are of the light if one is: "cyan and magenta light". A color before a
    substance is of the substance: "gray stone" colors no light. A color before a night is of all light: "a blue night".
    """
    found, rigs = list(row), rig_table().rigs
    for n, (first, second) in enumerate(pairwise(row)):
        apart = second.look.index - first.look.index
        lit = [pair.target.kind == "light" and pair.target.mention < 0 for pair in (first, second)]
        if not first.look.token.color:
            continue
        if apart == 2 and second.look.token.color and sum(lit) == 1 and row[other := n + lit[0]].target.mention < 0:
            found[other] = next((p for p in ranked[other] if p.target.kind == "light"), row[other])
        elif apart == 1 and lit[0] and vocabulary.slot(second.look.token.entry) == "material":
            found[n] = next((p for p in ranked[n] if p.target.kind == second.target.kind), first)
        elif apart == 1 and first.target.kind == "sky" and first.target.mention < 0:
            night = second.look.token.entry in rigs and rigs[second.look.token.entry].has_dark_sky
            found[n] = next((p for p in ranked[n] if night and p.target.kind == "picture"), first)
    return found


def _attributes_of(read: PromptReading, number: int) -> list[Attribute] | None:
    """The attributes of a look word; [] if it is not used, None if it is part of another word or of a name."""
    pair = read.chosen[number]
    kind, token, entry = pair.target.kind, pair.look.token, pair.sense.entry
    if pair.chosen:
        if kind == "none":
            return []
        thing = _thing(read, pair)
        return _attributes(read, pair, entry, replace(thing, thing=pair.chosen) if pair.target.names else thing)
    # "pier", if the scene has one
    is_a_name = any(m.named and m.covers(pair.look.index) for m in read.pairs.mentions)
    is_a_place = read.vocabulary.slot(token.entry) in ("setting", "mood")
    if is_a_name and is_a_place and kind not in MATTER:  # "garage" of "the garage door"
        return None
    rig = rig_table().rigs.get(token.entry)
    mentions = {p.target.mention for p in read.chosen if p is not pair and p.target.kind in MATTER} - {-1}
    is_described = any(read.pairs.mentions[mention].covers(pair.look.index) for mention in mentions)
    # "fire" of "blue fire" is the object that "blue" describes; an hour describes the image, even if a lamp is a "sun"
    if kind == "light" and is_a_name and is_described and not (rig and rig.kind in TIMES):
        return None
    if number in read.absent or _is_unsure(read, number):
        return []
    if kind == "none":
        return None if is_a_name else []
    for after in read.chosen[number + 1 : number + 2]:  # "emerald" of "emerald velvet" is a color
        adjoins = token.color and after.look.index == pair.look.index + 1
        entry = "" if adjoins and after.sense.slot == pair.sense.slot == "material" else entry
    return _attributes(read, pair, entry, _thing(read, pair))


def _is_unsure(read: PromptReading, number: int) -> bool:
    """True if look word `number` is probably used for no look, and no noun names its target."""
    target = read.chosen[number].target
    if target.mention >= 0 or target.kind not in (*MATTER, "picture") or len(read.chosen) == 1:
        return False
    return sum(share for each, share in read.probabilities[number] if each.target.kind == "none") > _UNSURE


def _attributes(read: PromptReading, pair: TargetPair, entry: str, thing: Attribute) -> list[Attribute]:
    """The attribute of a look word at target `thing`, then, for a mood, those of its plain wording without a scene."""
    word, token = pair.look, pair.look.token
    known = read.vocabulary.entries.get(entry)
    less = word.less
    if known and less and known.opposite and known.slot != "atmosphere":  # less fog is still fog
        less = False
        known, word = read.vocabulary.entries[known.opposite], replace(word, strength=_LESS)
    own = replace(
        thing,
        word=word.text,
        entry=known.name if known else token.name or token.text,
        slot=known.slot if known else "color",
        strength=word.strength,
        negated=word.negated,
        less=less,
        color=None if known else token.color,
        guess=bool(token.guess),
        shades=token.shades if known else (),
    )
    if not known or not known.means or word.negated:
        return [own]
    if read.is_part:
        raise VibeError(f"Vocabulary: '{known.name}', for which a mood stands, is a mood itself.", _PLAIN)
    found = [own]
    for text in known.means.split(","):
        meant = read_words(text, SceneDescription(), read.vocabulary, read.weights, is_part=True)
        if not meant.parsed.attributes:
            problem = f"Vocabulary: '{text.strip()}', for which '{known.name}' stands, is no look."
            raise VibeError(problem, _PLAIN)
        for part in meant.parsed.attributes:
            if part.slot == "grade" or thing.kind != "tone":  # "a moody grade" means no light
                strength = min(max(part.strength * word.strength, WEAKEST), STRONGEST)
                found.append(replace(part, cause=word.text, strength=strength, guess=bool(token.guess)))
    return found


def _thing(read: PromptReading, pair: TargetPair) -> Attribute:
    """The target of a pair as an attribute with an empty word; one with a surface is added to `read.mentioned`."""
    target, slot, word = pair.target, pair.sense.slot, pair.look.token.text
    kind, is_named = target.kind, target.mention >= 0
    if kind in MATTER:
        return _matter(read, pair)
    name = read.pairs.mentions[target.mention].text if is_named else word
    if kind == "picture":  # the image, or what words of a slot are usually about
        if slot == "color":
            return _of("tone", name, "whole") if is_named else _of("ambience", "tint", "whole")
        about = "tone" if pair.sense.way == "row" else _OF_SLOT.get(slot, "whole")
        return _of(about, word, "surroundings" if about == "surroundings" else "whole")
    region: Region = "surroundings" if kind == "sky" else "whole"
    apart = kind == "lights" and target.names != {*read.scene.lights}  # all lights are light as a whole
    lights = tuple(sorted(target.names)) if apart else ()
    role = kind if kind in ROLES else ""
    return replace(_of(_KINDS.get(kind, kind), name, region), role=role, lights=lights)


def _of(kind: str, thing: str, region: Region, owners: tuple[str, ...] = ()) -> Attribute:
    return Attribute("", "", "", region, kind, owners=owners, thing=thing)


def _matter(read: PromptReading, pair: TargetPair) -> Attribute:
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
    # "background" for the only wall, or "the rest" for all walls, means all surroundings, with the sky
    by_kind = target.kind == "others" or any(s.endswith("synonym") for s in target.signs)
    if pair.sense.slot == "setting" or (by_kind and {*owners} == materials_of("surroundings", scene)):
        region, owners = "surroundings", ()
    read.mentioned.append((name, region, owners))
    return _of(region, name, region, owners)


class AbsentObjects:
    """Finds nouns of a prompt that name an object which the scene lacks.

    A single such noun is the artist's name for the subject, if the subject has one color and no other noun names it.
    """

    def __init__(self, found: PromptPairs, scene: SceneDescription, vocabulary: Vocabulary) -> None:
        self._found, self._scene, self._vocabulary = found, scene, vocabulary
        self._own = OwnNouns(found.passage, found.mentions, vocabulary)
        subject = materials_of("subject", scene)
        self._looks = {name: look for name, look in scene.looks.items() if name in subject and not is_detail(name)}
        self._main = max(self._looks, key=lambda name: self._looks[name].share, default="")
        self.subject = self._subject_name()  # the prompt's name for the subject, or ""

    def noun_of(self, pair: TargetPair) -> str:
        """The noun that a look word describes, if the scene lacks its object; else ""."""
        token = pair.look.token
        slot = "color" if token.color else self._vocabulary.slot(token.entry) or pair.sense.slot
        # "darker" of a thing is a color; with no thing in the prompt, it describes the whole image
        sense = sense_at(token, "things", self._vocabulary) if pair.target.kind == "picture" else None
        may_lack = self._scene.materials and (slot in SURFACE or (sense and sense.way == "row"))
        own = self._own.of(pair.look.index) if may_lack else None
        return own.text if own and own.text != self.subject and self._is_absent(own) else ""

    def _is_absent(self, noun: NounMention) -> bool:
        """True if a noun names an object that the scene lacks."""
        words, seen = self._vocabulary.words, bool(self._scene.looks)
        if noun.named or noun.noun == "unknown":
            return not noun.named
        if noun.noun == "surroundings":
            shaped = any(noun.text in words[kind] for kind in STRUCTURES)
            return shaped and seen and len(materials_of("surroundings", self._scene)) != 1
        is_part = noun.noun == "subject" and noun.text not in words["whole"]
        return is_part and seen and not self._is_of_one_color()

    def _subject_name(self) -> str:
        """The only absent object that look words describe: the artist's name for the subject; "" if it is unclear."""
        mentions, looks = self._found.mentions, self._found.passage.looks
        places = {look.index for look in looks}  # "a dim workshop" is a look of the whole image
        nouns = [n for look in looks if (n := self._own.of(look.index)) and n.start not in places]
        names = {n.text for n in nouns if n.noun == "unknown" and self._is_absent(n)}
        smaller = name_words("limbs") | name_words("details") | name_words("accessories")
        # of bottle and "cap", the bottle is the subject, and a plural such as "wheels" never is
        whole = {n for n in names if smaller.isdisjoint((n, singular(n)))}
        names = whole or {n for n in names if not n.endswith("s")}
        theirs = {name for m in mentions for n in m.named if n.kind == "things" for name in n.names}
        named = any(m.noun == "subject" for m in mentions) or theirs & materials_of("subject", self._scene)
        is_clear = len(names) == 1 and names.isdisjoint(self._vocabulary.words["scenery"]) and not named
        return names.pop() if is_clear and self._is_of_one_color() and not self._has_a_name() else ""

    def _has_a_name(self) -> bool:
        """True if the subject's largest part is named after what it is, not after a substance, a part or a shape."""
        general = frozenset[str]().union(*map(name_words, ("primitives", "limbs", "details", "pipeline")))
        wearers = (name for name, worn in self._scene.object_materials.items() if self._main in worn)
        words = {word for name in (self._main, *wearers) for word in parts(name)}
        senses = {word: thing_words().get(word, frozenset()) for word in words}  # in English, too
        known = (word for word in words if senses[word] and not is_of_surfaces(word, self._vocabulary))
        tells = any(general.isdisjoint({word} if word in senses[word] else senses[word]) for word in known)
        return tells and len(self._scene.materials) > 1

    def _is_of_one_color(self) -> bool:
        """True if most of the visible subject has one color, or if no colors are known."""
        main = self._looks.get(self._main, MaterialLook())
        alike = (x.share for x in self._looks.values() if x is main or is_alike(x.color, main.color))
        return not self._main or sum(alike) > _MAIN * sum(look.share for look in self._looks.values())
