# SPDX-License-Identifier: Apache-2.0
"""Understands a prompt: finds its look words and what each of them describes, and explains why."""

from __future__ import annotations

import itertools
import math
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace

from ..schema import VibeError
from ..schema.limits import LONGEST_PROMPT
from ..schema.material_copies import copied, copy_name, every
from ..schema.options import checks
from ..schema.parameters import Region
from ..schema.targets import GENERAL, NOT_USED, OFFERED, joined
from .attributes import complete
from .foreign import Gloss, Retelling, gloss, other_language, understood
from .lexer import Token
from .lexicon.entries import normalize
from .lexicon.vocabulary import Vocabulary, default_vocabulary
from .mentions import mentions, named_objects
from .model import FactWeights, scores
from .names import fit, parts
from .normalized import Normalized, normalized
from .passage import Passage, passage
from .reader import PromptReading, read_words
from .scene import SceneIndex
from .targets import described_name, key_numbers, plain_key, sense_at, target_name
from .types import Attribute, Candidate, MaterialLook, Parsed, PromptWord, SceneDescription

_TAG = re.compile(r"</?[a-zA-Z][^<>]{0,200}>|\x1b\[[0-9;]*[A-Za-z]|[\x00-\x08\x0e-\x1f\x7f]")
_STUCK = "'{text}' is not changed: other objects have its material '{material}' too. Make it single-user in Blender."
_THINGS_STAY = "things are not added, moved or removed, only their look changes."
_LEAST = 0.02  # least probability of a candidate
_MOST = 16  # most objects, and most lights, that a word's menu offers in addition to its candidates
_TARGETS, _FACTS = 4, 4  # lines of `why` for each look word, and facts in each line


class Understood:
    """A prompt, read once against one description of a scene, for everyone who needs to know what it says.

    Attributes:
        prompt: As the artist typed it.
        scene: The description of the scene, with copies of materials that the words need.
        words: The look words of the prompt and the words that are left out, in its order.
        unknown: The error that says why nothing is understood; None if something is.
    """

    def __init__(self, prompt: str, scene: SceneDescription, told: Iterable[str] = ()) -> None:
        """Reads the prompt. `told`: texts WORD=TARGET, targets that the artist has chosen for words: "copper=Cup"."""
        self.prompt, self.scene, self._parsed = prompt, scene, Parsed("")
        self.unknown: VibeError | None
        vocabulary = default_vocabulary()
        try:
            found = passage(_opened(prompt, scene, vocabulary)[2].text, scene, vocabulary)
            self.scene, stuck = _with_own_materials(found, scene, vocabulary)
            self._parsed = parsed = read(prompt, self.scene, vocabulary, told=checks.targets(told))
            parsed.notes += stuck.values()
            parsed.protected = (*parsed.protected, *(f"material/{name}" for name in stuck))
            self.unknown = parsed.unknown
        except VibeError as error:
            self.unknown = error
        self.words = self._parsed.words

    @property
    def parsed(self) -> Parsed:
        """The prompt as read; callers may not change it. Raises VibeError if nothing in the prompt is understood."""
        if self.unknown:
            raise self.unknown
        return self._parsed


def prepared(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> str:
    """A prompt in English, rewritten in words that the reader knows, see `normalized`."""
    return normalized(gloss(text, scene, vocabulary).english, scene, vocabulary).text


def _opened(prompt: str, scene: SceneDescription, vocabulary: Vocabulary) -> tuple[Gloss, bool, Normalized]:
    """A prompt in English words; True if some of it is in a language that is not understood; and its normalized form.

    Raises VibeError if it is empty, too long, or in a language that is not understood.
    """
    text = " ".join(_TAG.sub(" ", prompt).split())
    if not text:
        remedy = "Describe a look, for example: 'glossy teal, white studio background'."
        raise VibeError("The prompt is empty.", remedy)
    if len(text) > LONGEST_PROMPT:
        raise VibeError(f"The prompt has {len(text)} characters.", f"Say it in {LONGEST_PROMPT} or less.")
    glossed = gloss(text, scene, vocabulary)
    foreign = "" if glossed.language else other_language(text)
    if foreign == "all":
        raise VibeError(f"The prompt '{text[:60]}' is in a language that is not understood.", understood())
    return glossed, bool(foreign), normalized(glossed.english, scene, vocabulary)


def refuse_without_look(prompt: str) -> None:
    """Raises VibeError, as `parse` does, if a prompt names no look in any scene; for use before Blender is started."""
    scene, vocabulary = SceneDescription(), default_vocabulary()
    glossed, mixed, normal = _opened(prompt, scene, vocabulary)
    found = passage(normal.text, scene, vocabulary, glossed.unknown)
    if not (found.looks or normal.links or normal.notes):
        raise _without_look(glossed, mixed, undone=bool(found.wishes))


def _without_look(glossed: Gloss, mixed: bool, undone: bool, lacking: Iterable[str] = ()) -> VibeError:
    language = glossed.language or ("English" if mixed else "")
    return VibeError(
        f"Nothing in the prompt '{glossed.prompt[:60]}' names a look{f' in {language}' if language else ''}"
        + (f": {_THINGS_STAY}" if undone else ".")
        + "".join(f" {note}" for note in lacking),
        "Name colors (teal), materials (glossy, gold), light (warm soft light), fog, grading (noir, vignette) "
        "or a mood (cosy, ominous).",
    )


def parse(
    prompt: str,
    scene: SceneDescription,
    vocabulary: Vocabulary | None = None,
    weights: FactWeights | None = None,
    told: Mapping[str, str] | None = None,
) -> Parsed:
    """The prompt as `read` gives it. Raises VibeError as `read` does, and if nothing in the prompt is understood."""
    parsed = read(prompt, scene, vocabulary, weights, told)
    if parsed.unknown:
        raise parsed.unknown
    return parsed


def read(
    prompt: str,
    scene: SceneDescription,
    vocabulary: Vocabulary | None = None,
    weights: FactWeights | None = None,
    told: Mapping[str, str] | None = None,
) -> Parsed:
    """The look words of a prompt, bound to what they describe; if nothing is understood, `Parsed.unknown` says why.

    `told`: word -> the target that the artist chose for it, a name in the scene, "lights", "not used" and so on. Raises
    VibeError for a prompt that is empty, too long or in an unknown language, and for a target that is not possible.
    """
    vocabulary = vocabulary or default_vocabulary()
    glossed, mixed, normal = _opened(prompt, scene, vocabulary)
    retelling = Retelling(glossed)
    english = {w: retelling.english(w) for w in map(plain_key, told or ()) if glossed.language}
    targets = {**normal.targets, **(told or {})}
    reading = read_words(
        normal.text, scene, vocabulary, weights, foreign=glossed.unknown, targets=targets, english=english
    )
    parsed, found = reading.parsed, reading.pairs.passage
    parsed.prompt = glossed.prompt
    # in "darker sky, but leave the mountains", the world is not protected with the mountains
    spoken_of = {"world"} if any(a.kind == "sky" for a in parsed.attributes) else set()
    protections = [(text, [key for key in kept if key not in spoken_of]) for text, kept in normal.protections]
    parsed.protected = tuple(dict.fromkeys(key for _, kept in protections for key in kept))
    parsed.links = tuple(normal.links)
    parsed.notes += normal.notes
    for text, kept in protections:
        names = ", ".join(key.partition("/")[2] or key for key in kept)
        parsed.notes.append(f"'{text}': {names or 'what no word names'} stays as it is.")
    undone = [" ".join(words) for words in found.wishes]
    parsed.undone = bool(undone)
    if found.beyond:
        nothing = "no value of a material, light, world, fog or film gives that."
        parsed.notes.append(f"{_quoted(found.beyond)}: {nothing}")
    if undone:
        parsed.notes.append(f"{_quoted(undone)}: {_THINGS_STAY}")
    if mixed:
        parsed.notes.append(f"Some of the prompt is in a language that is not understood. {understood()}")
    if not (parsed.attributes or parsed.links) or (
        mixed and parsed.attributes and all(a.guess or a.cause for a in parsed.attributes)
    ):
        parsed.unknown = _without_look(glossed, mixed, bool(undone), [*reading.lacking, *normal.notes])
    complete(parsed, reading.subject, reading.mentioned, scene.sky)
    if glossed.language:
        retelling.retell(parsed)
    if glossed.language and glossed.unknown:
        lacks = f"The prompt was read as {glossed.language}, which lacks: {_quoted(glossed.unknown)}."
        parsed.notes.append(lacks)
    parsed.words = _prompt_words(reading, parsed, retelling.own)
    return parsed


def _quoted(words: Iterable[str]) -> str:
    return ", ".join(f"'{word}'" for word in dict.fromkeys(words))


# Explanations for people


def why(reading: PromptReading) -> str:
    """A text: each look word with its likeliest targets and their main facts; an arrow marks the chosen target."""
    lines = ["Why (each look word with its likeliest targets, and the facts that weigh most)"]
    weights = reading.weights
    for pairs, chosen in zip(reading.pairs.pairs, reading.chosen, strict=True):
        lines.append(f"  {chosen.look.text}")
        ranked = sorted(zip(scores(pairs, weights), pairs, strict=True), key=lambda both: -both[0])
        for score, pair in ranked[:_TARGETS] + [each for each in ranked[_TARGETS:] if each[1] is chosen]:
            facts = sorted(filter(weights.__contains__, pair.features), key=lambda name: -abs(weights[name]))
            most = ", ".join(f"{name} {weights[name]:+.1f}" for name in facts[:_FACTS])
            lines.append(f"   {'→' if pair is chosen else ' '} {math.exp(score):4.0%}  {pair.target}  ({most})")
    return "\n".join(lines)


def _prompt_words(reading: PromptReading, parsed: Parsed, own: Callable[[str], str]) -> tuple[PromptWord, ...]:
    """The look words and left-out words of a prompt, in its order; `own` gives the prompt's word for an English one."""
    numbers, prompt = key_numbers([pair.look.text for pair in reading.chosen]), parsed.prompt
    words = []
    for number, end in enumerate(numbers):
        said = [a for a in parsed.attributes if a.look == number and not a.cause]
        if said or number in reading.unused:  # others are part of another word, or of a name
            words.append(_look_word(reading, number, said, end, own))
    known = {word.text for word in words}
    words += [PromptWord(text, text) for text in dict.fromkeys(parsed.ignored) if text not in known]
    # Their places; words that the prompt spells otherwise come last
    placed, start = [], 0
    for word in words:
        text = r"[\W_]+".join(map(re.escape, re.findall(r"#?[^\W_]+", word.text)))
        pattern = re.compile(text or r"(?!)", re.IGNORECASE)
        match = pattern.search(prompt, start) or pattern.search(prompt)
        start = match.end() if match and word.candidates else start
        placed.append(replace(word, place=match.span() if match else None))
    return tuple(sorted(placed, key=lambda word: word.place or (len(prompt), len(prompt))))


def _look_word(
    reading: PromptReading, number: int, said: list[Attribute], end: str, own: Callable[[str], str]
) -> PromptWord:
    """Look word `number` for reports; `said`: its attributes, [] if left out; `end`: end of its key, "" or "#2"."""
    pair = reading.chosen[number]
    names = dict.fromkeys(pair.chosen or described_name(a, reading.scene) for a in said)
    candidates = _candidates(reading, number, next(iter(names), NOT_USED))
    offered = _offered(pair.look.token, reading.scene, reading.vocabulary)
    first = said[0] if said else Attribute(own(pair.look.text), "", "", "whole")
    return PromptWord(
        text=first.word,
        key=normalize(own(pair.look.text)) + end,
        entry=first.entry,
        strength=pair.look.strength,
        negated=pair.look.negated,
        target=joined(names) if names else NOT_USED,
        thing=first.thing if first.thing not in first.word else "",
        confidence=candidates[0].probability,
        candidates=candidates,
        others=tuple(name for name in offered if name not in {c.name for c in candidates}),
        guess=pair.look.token.guess,
    )


def _candidates(reading: PromptReading, number: int, target: str) -> tuple[Candidate, ...]:
    """The `target` of look word `number`, then other targets, the likeliest first; the menu adds "not used"."""
    chosen = reading.chosen[number]
    found = {target: 0.0}
    for pair, probability in reading.probabilities[number]:
        is_chosen = pair.target == chosen.target and target != NOT_USED
        if name := target if is_chosen else target_name(pair.target, reading.scene):
            found[name] = found.get(name, 0.0) + probability
    if chosen.chosen or number in reading.absent:
        found[target] = 1.0
    others = {n: p for n, p in found.items() if p >= _LEAST and n not in (target, NOT_USED)}
    likely = [target, *sorted(others, key=lambda name: -others[name])]
    return tuple(Candidate(name, round(found[name], 3)) for name in likely)


def _offered(token: Token, scene: SceneDescription, vocabulary: Vocabulary) -> Iterator[str]:
    """Yields names that a word can describe: objects, the largest in the image first; lights; then general names."""
    if sense_at(token, "things", vocabulary):
        yield from scene.made(_largest, vocabulary)
    if sense_at(token, "lights", vocabulary):
        yield from [*scene.lights][:_MOST]
    own = {name.casefold() for name in scene.lights}  # "Key Light" of the scene is enough
    yield from (n for n in OFFERED if n not in own and sense_at(token, GENERAL[n], vocabulary))


def _largest(scene: SceneDescription, _: Vocabulary) -> list[str]:
    """Names of the objects that cover most of the image, the largest first, at most `_MOST`."""

    def share(name: str) -> float:
        looks = (scene.looks[m] for m in scene.object_materials[name] if m in scene.looks)
        return sum(look.worn.get(name, 0.0) for look in looks)

    return sorted(scene.object_materials, key=share, reverse=True)[:_MOST]


# Copies of shared materials, so that no other object changes with the one that is named


def _with_own_materials(
    passage: Passage, scene: SceneDescription, vocabulary: Vocabulary
) -> tuple[SceneDescription, dict[str, str]]:
    """The scene, with copies of materials that objects in the prompt share with other objects.

    Also returns: material that cannot be copied -> a sentence that says so.
    """
    wearers: dict[str, list[str]] = defaultdict(list)
    for thing, worn in scene.object_materials.items():
        for material in worn:
            wearers[material].append(thing)
    shared = {m: its for m, its in wearers.items() if len(its) > 1}
    if not scene.looks or not shared:
        return scene, {}
    index, copies, stuck = scene.made(SceneIndex, vocabulary), dict[str, list[str]](), dict[str, str]()
    named = []
    for mention in mentions(passage, index, vocabulary):
        mine = {o for thing in named_objects(mention, index) for o in (thing, *index.parts_of(thing))}
        named.append((mine, mention.text))
    named.sort(key=lambda each: len(each[0]))
    done = set[tuple[str, str]]()
    for (mine, text), (material, its) in itertools.product(named, shared.items()):
        theirs = [thing for thing in its if thing in mine and (material, thing) not in done]
        # a material with the object's name is meant itself, for all objects that wear it
        named_so = any(fit(parts(name), parts(material), vocabulary) for name in (text, *theirs))
        if not theirs or mine.issuperset(its) or named_so:
            continue
        done |= {(material, thing) for thing in theirs}
        found = _copies(material, theirs, scene)
        copies |= found
        if {*theirs}.difference(*found.values()):
            stuck[material] = _STUCK.format(text=text, material=material)
    return (_with_copies(scene, copies) if copies else scene), stuck


def _copies(material: str, wearers: list[str], scene: SceneDescription) -> dict[str, list[str]]:
    """Name of a copy -> those of `wearers` that get it; several copies if the name of one is too long for Blender."""
    each: dict[str, list[str]] = defaultdict(list)
    count, mine = Counter(map(every, scene.objects)), Counter(map(every, wearers))
    for thing in wearers:
        who = every(thing)
        each[who if 1 < count[who] == mine[who] else thing].append(thing)
    together = copy_name(material, [*each])
    found = {together: wearers} if together else {copy_name(material, [who]): o for who, o in each.items()}
    return {name: things for name, things in found.items() if name and name not in scene.materials}


def _with_copies(scene: SceneDescription, copies: dict[str, list[str]]) -> SceneDescription:
    theirs = {(copied(name)[0], o): name for name, things in copies.items() for o in things}
    worn = {o: tuple(theirs.get((m, o), m) for m in its) for o, its in scene.object_materials.items()}
    sources = {name: copied(name)[0] for name in copies}
    looks, emitters = dict(scene.looks), dict(scene.emitters)
    for name, material in sources.items():
        if look := looks.get(material):
            looks[name], looks[material] = _split(look, copies[name])
        if glow := emitters.get(material):
            emitters[name] = replace(glow, objects=tuple(o for o in glow.objects if o in copies[name]))

    def region(material: str) -> Region:
        mine = (o for o, its in worn.items() if material in its)
        return "subject" if any(scene.objects[o] == "subject" for o in mine) else "surroundings"

    luminance = scene.texture_luminance
    return replace(
        scene,
        materials=scene.materials | {name: region(name) for name in (*copies, *sources.values())},
        object_materials=worn,
        looks=looks,
        emitters=emitters,
        glows=(*scene.glows, *(name for name in copies if sources[name] in scene.glows)),
        texture_luminance=luminance | {n: luminance[m] for n, m in sources.items() if m in luminance},
        copies={name: tuple(things) for name, things in copies.items()},
    )


def _split(look: MaterialLook, things: list[str]) -> tuple[MaterialLook, MaterialLook]:
    """The look of a material on the objects `things`, and on all others; its `structures` stay with the larger part."""
    mine = {o: share for o, share in look.worn.items() if o in things}
    rest = {o: share for o, share in look.worn.items() if o not in things}
    one, other = (replace(look, share=sum(worn.values()), worn=worn) for worn in (mine, rest))
    if one.share < other.share:
        return replace(one, structures=frozenset()), other
    return one, replace(other, structures=frozenset())
