# SPDX-License-Identifier: Apache-2.0
"""Objects that a prompt names: the noun of a look word, objects that the scene lacks, and copies of materials that objects share."""

import itertools
from collections import Counter, defaultdict
from dataclasses import replace

from ..schema.material_copies import copied, copy_name, every
from ..schema.parameters import Region
from .lexicon.languages import name_words, singular, thing_words
from .lexicon.vocabulary import Vocabulary
from .mentions import mentions, named_objects
from .names import fit, is_detail, is_of_surfaces, parts
from .passage import STRUCTURES, Passage, is_object
from .scene import NounMention, SceneIndex, is_alike, materials_of
from .targets import SURFACE, PromptPairs, TargetPair, sense_at
from .types import MaterialLook, SceneDescription

# a look word after one describes no noun before it: "a cup on red"
_STOPS = ("around", "comparison", "exception")
_MAIN = 0.7  # least share of the subject that has one color, for a subject of one material


class OwnNouns:
    """Finds the nouns that look words describe."""

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self._items, self._vocabulary = passage.items, vocabulary
        self._looks = {look.index for look in passage.looks}
        self._at = {p: m for m in mentions if m.members == 1 for p in range(m.start, m.end + 1)}

    def of(self, look: int) -> NounMention | None:
        """The noun that a look word describes; None if that is not certain."""
        if self._items[look].change:
            return self.changed(look)
        return self._after(look) or self._before(look)

    def changed(self, look: int) -> NounMention | None:
        """The object of the change phrase that a look word is in: the roof of "the roof from red to grey"."""
        change, items = self._items[look].change, enumerate(self._items)
        places = (p for p, item in items if change and item.presents and item.change == change)
        return next((self._at[place] for place in places if place in self._at), None)

    def _after(self, look: int) -> NounMention | None:
        """The noun after a look word: "a red roof"; of several the last, unless the scene has only an earlier one."""
        found, led = None, self._led(look)
        for place in range(look + 1, len(self._items)):
            item = self._items[place]
            if item.clause != self._items[look].clause and (found or not led):
                break  # "a crisp, pale beam" goes on
            noun = self._noun(place)
            if noun and (led or self._is_a_noun(noun)):
                found = noun if not found or noun.named or not found.named else found
            elif found or not (item.names_a_look or item.strength is not None):
                break
        return found

    def _before(self, look: int) -> NounMention | None:
        """The noun before a look word: "the roof is red"; a noun of the scene rather than one without an article."""
        found = None
        for place in range(look - 1, -1, -1):
            item = self._items[place]
            apart = item.clause != self._items[look].clause
            if apart or not item.lists.isdisjoint(_STOPS) or item.text == "with":
                break
            noun = self._noun(place)
            if noun and (noun.named or (not found and self._is_a_noun(noun))):
                found = noun
            if noun and (place in self._looks or noun.named or self._led(noun.start)):
                break
        return found

    def _noun(self, place: int) -> NounMention | None:
        item = self._items[place]
        if place in self._at:
            return self._at[place]
        if item.entry and item.text.endswith(("light", "lights")):  # "moonlight"
            return NounMention(place, place, item.text, "light")
        scenery = place - 1 in self._looks and item.text in self._vocabulary.words["scenery"]
        is_noun = not item.filler and (scenery or is_object(item, self._vocabulary))
        return NounMention(place, place, item.text, item.noun or "unknown") if is_noun else None

    def _is_a_noun(self, noun: NounMention) -> bool:
        """True if a word is a noun by itself, or by the article before it."""
        listed = singular(noun.text) in thing_words()
        return bool(noun.named) or noun.noun != "unknown" or listed or self._led(noun.start)

    def _led(self, place: int) -> bool:
        """True if an article stands before a word and the looks before it."""
        while place > 0 and (self._items[place - 1].names_a_look or self._items[place - 1].strength):
            place -= 1
        return place > 0 and not self._items[place - 1].lists.isdisjoint(("article", "definite"))


class AbsentObjects:
    """Nouns of a prompt that name an object which its scene lacks.

    A single one is the artist's name for the subject, if the subject is of one material and no other noun names it.
    """

    def __init__(self, found: PromptPairs, scene: SceneDescription, vocabulary: Vocabulary) -> None:
        self._found, self._scene, self._vocabulary = found, scene, vocabulary
        self._own = OwnNouns(found.passage, found.mentions, vocabulary)
        self.subject = self._subject_name()  # the prompt's name for the subject, or ""

    def noun_of(self, pair: TargetPair) -> str:
        """The absent object that a look word describes; "" where it describes none."""
        token = pair.look.token
        slot = "color" if token.color else self._vocabulary.slot(token.entry) or pair.sense.slot
        # "darker" of a thing is a color, though where no thing is said it would be of the whole image
        sense = sense_at(token, "things", self._vocabulary) if pair.target.kind == "picture" else None
        may_lack = self._scene.materials and (slot in SURFACE or (sense and sense.way == "row"))
        own = self._own.of(pair.look.index) if may_lack else None
        return own.text if own and own.text != self.subject and self._is_absent(own) else ""

    def _is_absent(self, noun: NounMention) -> bool:
        """True if a noun names an object, and none in the scene."""
        words, seen = self._vocabulary.words, bool(self._scene.looks)
        if noun.named or noun.noun == "unknown":
            return not noun.named
        if noun.noun == "surroundings":
            shaped = any(noun.text in words[kind] for kind in STRUCTURES)
            return shaped and seen and len(materials_of("surroundings", self._scene)) != 1
        is_part = noun.noun == "subject" and noun.text not in words["whole"]
        return is_part and seen and not self._is_of_one_material()

    def _subject_name(self) -> str:
        """The only absent object that the prompt describes, as its name for the subject; "" if the subject has a clear name."""
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
        is_clear = len(names) == 1 and names.isdisjoint(self._vocabulary.words["scenery"])
        is_clear = is_clear and not named and not self._has_a_name() and self._is_of_one_material()
        return names.pop() if is_clear else ""

    def _has_a_name(self) -> bool:
        """True if names in the scene say what most of the visible subject is, so that another noun does not mean it."""
        scene, named, whole = self._scene, 0.0, 0.0
        for material, thing in ((m, o) for o, worn in scene.object_materials.items() for m in worn):
            look = scene.looks.get(material, MaterialLook())
            if scene.objects.get(thing) == scene.materials.get(material) == "subject":
                area = look.worn.get(thing, 0.0) if look.worn else look.share
                whole += area
                named += area * (self._tells(thing) or self._tells(material))
        return len(scene.materials) > 1 and named > 0.5 * whole

    def _tells(self, name: str) -> bool:
        """True if a name says what a thing is, and not only its substance, its part or its shape: no "Gold", no "Head"."""
        general = frozenset[str]().union(*map(name_words, ("primitives", "limbs", "details", "pipeline")))
        senses = {word: thing_words().get(word, frozenset()) for word in parts(name)}  # in English, too
        known = (word for word in senses if senses[word] and not is_of_surfaces(word, self._vocabulary))
        return any(general.isdisjoint({word} if word in senses[word] else senses[word]) for word in known)

    def _is_of_one_material(self) -> bool:
        """True if most of the visible subject has one color, or if no colors are known."""
        mine = (n for n in materials_of("subject", self._scene) if not is_detail(n))
        looks = [self._scene.looks[name] for name in mine if name in self._scene.looks]
        main = max(looks, key=lambda look: look.share, default=None)
        alike = sum(x.share for x in looks if main and (x is main or is_alike(x.color, main.color)))
        return main is None or alike > _MAIN * sum(look.share for look in looks)


# Copies of shared materials, so that no other object changes with the one that is named

_STUCK = "'{text}' is not changed: other objects have its material '{material}' too. Make it single-user in Blender."


def with_own_materials(
    passage: Passage, scene: SceneDescription, vocabulary: Vocabulary
) -> tuple[SceneDescription, dict[str, str]]:
    """The scene with copies of materials that objects of the prompt share with others.

    Also returns, for each material that cannot be copied, a sentence that says so.
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
        if not theirs or mine.issuperset(its) or fit(parts(text), parts(material), vocabulary):
            continue
        done |= {(material, thing) for thing in theirs}
        found = _copies(material, theirs, scene)
        copies |= found
        if {*theirs}.difference(*found.values()):
            stuck[material] = _STUCK.format(text=text, material=material)
    return (_with_copies(scene, copies) if copies else scene), stuck


def _copies(material: str, wearers: list[str], scene: SceneDescription) -> dict[str, list[str]]:
    """Name of a copy -> the objects that wear it; several copies if the name of one for all is too long for Blender."""
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
    """The look of a material on some objects, and on all others; its `structures` stay with the larger part."""
    mine = {o: share for o, share in look.worn.items() if o in things}
    rest = {o: share for o, share in look.worn.items() if o not in things}
    one, other = (replace(look, share=sum(worn.values()), worn=worn) for worn in (mine, rest))
    if one.share < other.share:
        return replace(one, structures=frozenset()), other
    return one, replace(other, structures=frozenset())
