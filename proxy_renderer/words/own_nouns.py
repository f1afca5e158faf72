# SPDX-License-Identifier: Apache-2.0
"""Objects that a prompt names: the noun of a look word, objects that the scene lacks, and copies of materials that objects share."""

import itertools
from collections import Counter, defaultdict
from dataclasses import replace

from ..schema.material_copies import copied, copy_name, every
from .lexicon.languages import singular, thing_words
from .lexicon.vocabulary import Vocabulary
from .mentions import mentions, named_objects
from .names import fit, is_detail, is_of_surfaces, name_words, parts
from .passage import STRUCTURES, Passage, is_object
from .scene import NounMention, SceneIndex, is_alike, materials_of
from .targets import MATTER, SURFACE, PromptPairs, TargetPair
from .types import MaterialLook, SceneDescription

_NO_MATTER = ("light", "fill", "rim", "sky", "fog", "shadow")  # kinds of nouns without a surface
_STOPS = ("around", "comparison", "exception")  # no look crosses them to the noun: "a cup on red"
_MAIN = 0.6  # share of the subject from which one material is what a name for the subject means
_ALL = 0.95  # the same of a name for what things wear: a snowman is no scarf
_WIDE = 0.5  # share of the image's width from which something upright or level may be a part of a room


class OwnNouns:
    """Finds the nouns of look words."""

    def __init__(self, passage: Passage, mentions: list[NounMention], vocabulary: Vocabulary) -> None:
        self._items, self._vocabulary = passage.items, vocabulary
        self._looks = {look.index for look in passage.looks}
        self._at = {p: m for m in mentions if m.members == 1 for p in range(m.start, m.end + 1)}

    def of(self, look: int) -> NounMention | None:
        """The noun that a look word is said of; None where that is not certain."""
        if change := self._change(look):
            changed = (p for p, item in enumerate(self._items) if item.presents and item.change == change)
            return next((self._at[place] for place in changed if place in self._at), None)
        return self._purpose(look) or self._after(look) or self._before(look)

    def changed(self, look: int) -> NounMention | None:
        """The object of the change phrase that a look word is in, or that it goes on with: "from red to grey, still glossy"."""
        return self.of(look) if self._change(look) else None

    def ground(self, look: int) -> str:
        """Where a word about surfaces is said of what things stand on or before, "surroundings" or "sky"; "" where it is not.

        By the noun after it, as in "a cup before a teal backdrop", or by none: "a cup on green felt".
        """
        token = self._items[look]
        if not (token.color or self._vocabulary.slot(token.entry) in SURFACE) or self._change(look):
            return ""
        if after := self._after(look):
            is_place = after.noun in ("surroundings", "sky") and after.start not in self._looks
            return after.noun if is_place and not after.named else ""
        place = look
        run = itertools.takewhile(lambda p: self._items[p].names_a_look, range(look, len(self._items)))
        if any(noun.named for p in run if (noun := self._noun(p))):
            return ""
        while place > 0 and (self._items[place - 1].names_a_look or self._items[place - 1].strength):
            place -= 1
        clause = [p for p in range(place) if self._items[p].clause == token.clause]
        is_behind = bool(clause) and self._items[clause[-1]].text in self._vocabulary.words["behind"]
        return "surroundings" if is_behind and any(map(self._noun, clause)) else ""

    def _in_clause(self, clause: int) -> list[int]:
        return [place for place, item in enumerate(self._items) if item.clause == clause]

    def _change(self, look: int) -> int:
        """The number of the change phrase that a word is in, or that ends right before its clause, which has no noun."""
        token = self._items[look]
        if token.change or not (token.color or self._vocabulary.slot(token.entry) in ("finish", "material")):
            return token.change
        before = self._in_clause(token.clause - 1)
        if not before or any(self._noun(place) for place in self._in_clause(token.clause)):
            return 0
        return self._items[before[-1]].change

    def _purpose(self, look: int) -> NounMention | None:
        """The noun of "oak for the table"."""
        after = range(look + 1, len(self._items))
        place = next((p for p in after if not self._items[p].names_a_look), len(self._items))
        tie, article = self._items[place : place + 1], self._items[place + 1 : place + 2]
        is_for = any(i.text == "for" for i in tie) and any("article" in i.lists for i in article)
        return self._noun(place + 2) if is_for and place + 2 < len(self._items) else None

    def _after(self, look: int) -> NounMention | None:
        """The noun of "a red roof", the last one of "a red roof tile" unless the scene has only the other."""
        found = None
        for place in range(look + 1, len(self._items)):
            item = self._items[place]
            if item.clause != self._items[look].clause and (found or not self._led(look)):
                break  # "a crisp, pale beam" goes on
            noun = self._noun(place)
            if noun and (self._led(look) or self._is_a_noun(noun)):
                found = noun if not found or noun.named or not found.named else found
            elif found or not (item.names_a_look or item.strength is not None):
                break
        return found

    def _before(self, look: int) -> NounMention | None:
        """The noun of "the roof is red" and "the roof in dark red"; one that the scene has before one without an article."""
        found = None
        for place in range(look - 1, -1, -1):
            item = self._items[place]
            apart = item.clause != self._items[look].clause
            if apart or not item.lists.isdisjoint(_STOPS) or (item.ties and item.text == "with"):
                break
            noun = self._noun(place)
            if noun and (noun.named or (not found and self._is_a_noun(noun))):
                found = noun
            if noun and (place in self._looks or noun.named or self._led(noun.start)):
                break
        return found

    def _noun(self, place: int) -> NounMention | None:
        """The noun at a place, also one that is a filler elsewhere: "the frame"."""
        item, known = self._items[place], self._at.get(place)
        if known:
            return known
        if item.entry and item.text.endswith(("light", "lights")):  # "moonlight"
            return NounMention(place, place, item.text, "light")
        if item.filler:
            definite = place > 0 and "definite" in self._items[place - 1].lists
            is_noun = definite and item.text in thing_words().rows
        else:
            scenery = place - 1 in self._looks and item.text in self._vocabulary.words["scenery"]
            is_noun = scenery or is_object(item, self._vocabulary)
        return NounMention(place, place, item.text, item.noun or "unknown") if is_noun else None

    def _is_a_noun(self, noun: NounMention) -> bool:
        """Whether a word is a noun by itself, or by the article before it."""
        listed = singular(noun.text) in thing_words().rows
        return bool(noun.named) or noun.noun != "unknown" or listed or self._led(noun.start)

    def _led(self, place: int) -> bool:
        """Whether an article stands before a word and the looks before it."""
        while place > 0 and (self._items[place - 1].names_a_look or self._items[place - 1].strength):
            place -= 1
        return place > 0 and not self._items[place - 1].lists.isdisjoint(("article", "definite"))


class AbsentObjects:
    """Nouns of a prompt that name an object which its scene lacks.

    The only one of them is what the artist calls the subject, where the subject is of one material and no noun names it.

    Attributes:
        subject: What the prompt calls a subject whose names do not tell; "" for nothing.
    """

    def __init__(self, found: PromptPairs, scene: SceneDescription, vocabulary: Vocabulary) -> None:
        self._found, self._scene, self._vocabulary = found, scene, vocabulary
        self._own = OwnNouns(found.passage, found.mentions, vocabulary)
        self.subject = self._subject_name()

    def noun_of(self, pair: TargetPair) -> str:
        """The absent object that a look word describes; "" where it describes none."""
        own = self._own_of(pair) if self._scene.materials else None
        return own.text if own and own.text != self.subject and self._is_absent(own) else ""

    def is_astray(self, pair: TargetPair) -> bool:
        """Whether a word that is said of light or the like would paint an object: "a yellow beam on the rug"."""
        if pair.target.kind not in MATTER or pair.sense.slot == "material":
            return False
        own = self._own_of(pair)
        return own is not None and own.noun in _NO_MATTER and not own.named and own.start > pair.look.index

    def _own_of(self, pair: TargetPair) -> NounMention | None:
        """The noun that a word about surfaces is said of."""
        token = pair.look.token
        slot = "color" if token.color else self._vocabulary.slot(token.entry) or pair.sense.slot
        return self._own.of(pair.look.index) if slot in SURFACE else None

    def _is_absent(self, noun: NounMention) -> bool:
        """Whether a noun names an object, and none in the scene."""
        words, looks = self._vocabulary.words, bool(self._scene.looks)
        if noun.named:
            return False
        if noun.noun == "surroundings":
            shaped = any(noun.text in words[kind] for kind in STRUCTURES)
            return shaped and looks and len(materials_of("surroundings", self._scene)) != 1
        if noun.noun == "subject":
            return noun.text not in words["whole"] and looks and not self._is_of_one_material()
        return noun.noun == "unknown"

    def _subject_name(self) -> str:
        """The name that the prompt gives a subject whose names do not tell: the only object that it describes; "" for none."""
        mentions, looks = self._found.mentions, self._found.passage.looks
        places = {look.index for look in looks}  # "a dim workshop" is a look of the whole image
        nouns = [n for look in looks if (n := self._own.of(look.index)) and n.start not in places]
        absent = [noun for noun in nouns if self._is_absent(noun) and noun.noun == "unknown"]
        names = {noun.text for noun in absent} - self._vocabulary.words["scenery"]
        # "wheels" are a part, also of what has no other name; a "lamp" may be all there is
        parts_of_it = {name for name in names if singular(name) in name_words("details")}
        names -= {name for name in parts_of_it if name.endswith("s") or len(names) > 1}
        # beside its "cap", the bottle is the thing
        smaller = name_words("limbs") | name_words("accessories")
        names = {name for name in names if singular(name) not in smaller} or names
        if len(names) != 1 or any(m.members > 1 and m.covers(n.start) for m in mentions for n in absent):
            return ""
        theirs = {name for m in mentions for n in m.named if n.kind == "things" for name in n.names}
        named = any(m.noun == "subject" for m in mentions) or not theirs.isdisjoint(
            materials_of("subject", self._scene)
        )
        least = _ALL if names <= name_words("accessories") else _MAIN
        return "" if named or self._has_a_name() or not self._is_of_one_material(least) else names.pop()

    def _has_a_name(self) -> bool:
        """Whether half of what is seen of the subject is called what it is, so that nobody calls it otherwise."""
        scene, named, whole = self._scene, 0.0, 0.0
        for material in materials_of("subject", scene):
            look = scene.looks.get(material, MaterialLook())
            for thing in (o for o, worn in scene.object_materials.items() if material in worn):
                if scene.objects.get(thing) == "subject":
                    area = look.worn.get(thing, 0.0) if look.worn else look.share
                    whole += area
                    named += area * (self._tells(thing) or self._tells(material))
        return len(scene.materials) > 1 and named > 0.5 * whole

    def _tells(self, name: str) -> bool:
        """Whether a name says what a thing is, and not only its substance, its part or its shape: no "Gold", no "Head"."""
        general = frozenset[str]().union(*map(name_words, ("primitives", "limbs", "details", "pipeline")))
        tells = False
        for word in parts(name):
            senses = thing_words().rows.get(word, frozenset())  # in English: a "tête" is a head
            known = {word} if word in senses else senses
            tells |= bool(known) and known.isdisjoint(general) and not is_of_surfaces(word, self._vocabulary)
        return tells

    def _is_of_one_material(self, least: float = _MAIN) -> bool:
        """Whether the subject is of one material, up to a share, or of several of one color; where only names are known it may be."""
        mine = [n for n in materials_of("subject", self._scene) if not is_detail(n)]
        looks = [look for name in mine if (look := self._scene.looks.get(name))]
        if not looks or len(mine) < 2:
            return True
        main = max(looks, key=lambda look: look.share)
        like_it = (look.share for look in looks if look is main or is_alike(look.color, main.color))
        # a room's wall is wide; a robot that is as high as its scene is none
        widths = [self._scene.places.get(name, (0.0, 0.0, 1.0))[2] for name in main.worn]
        is_room = bool(main.structures) and max(widths, default=1.0) > _WIDE
        return not is_room and sum(like_it) > least * sum(look.share for look in looks)


# Copies of shared materials, so that no other object changes with the one that is named


_STUCK = "'{text}' is not changed: other objects have its material '{material}' too. Make it single-user in Blender."


def with_own_materials(
    passage: Passage, scene: SceneDescription, vocabulary: Vocabulary
) -> tuple[SceneDescription, dict[str, str]]:
    """The scene with copies of materials that objects of the prompt share, and a sentence on each that has to stay."""
    wearers: dict[str, list[str]] = defaultdict(list)
    for thing, worn in scene.object_materials.items():
        for material in worn:
            wearers[material].append(thing)
    shared = {m: its for m, its in wearers.items() if len(its) > 1}
    if not scene.looks or not shared:
        return scene, {}
    index, copies, done = scene.made(SceneIndex, vocabulary), dict[str, list[str]](), set[tuple[str, str]]()
    named, stuck = [], dict[str, str]()
    for mention in mentions(passage, index, vocabulary):
        mine = {o for thing in named_objects(mention, index) for o in (thing, *index.parts_of(thing))}
        named.append((mine, mention.text))
    for mine, text in sorted(named, key=lambda each: len(each[0])):  # "a red couch, white cushions"
        for material, its in shared.items():
            theirs = [thing for thing in its if thing in mine and (material, thing) not in done]
            # a material that is called like the object is meant, whoever wears it
            if not theirs or mine.issuperset(its) or fit(parts(text), parts(material), vocabulary):
                continue
            done |= {(material, thing) for thing in theirs}
            found = _copies(material, theirs, scene)
            copies |= found
            if {*theirs}.difference(*found.values()):
                stuck[material] = _STUCK.format(text=text, material=material)
    return (_with_copies(scene, copies) if copies else scene), stuck


def _copies(material: str, wearers: list[str], scene: SceneDescription) -> dict[str, list[str]]:
    """Name of a copy -> the objects that wear it; of several copies where Blender could not hold the name of one for all."""
    each: dict[str, list[str]] = defaultdict(list)
    count, mine = Counter(map(every, scene.objects)), Counter(map(every, wearers))
    for thing in wearers:
        who = every(thing)
        each[who if 1 < count[who] == mine[who] else thing].append(thing)
    found = {copy_name(material, [*each]): wearers}
    if "" in found:
        found = {copy_name(material, [who]): things for who, things in each.items()}
    return {name: things for name, things in found.items() if name and name not in scene.materials}


def _with_copies(scene: SceneDescription, copies: dict[str, list[str]]) -> SceneDescription:
    """A scene in which objects wear copies of their materials."""
    theirs = {(copied(name)[0], o): name for name, things in copies.items() for o in things}
    worn = {
        o: tuple(theirs.get((m, o), m) for m in materials) for o, materials in scene.object_materials.items()
    }
    regions, looks, emitters = dict(scene.materials), dict(scene.looks), dict(scene.emitters)
    for name, things in copies.items():
        material = copied(name)[0]
        regions[name] = "subject" if any(scene.objects[o] == "subject" for o in things) else "surroundings"
        if look := looks.get(material):
            looks[name], looks[material] = _split(look, things)
        if glow := emitters.get(material):
            emitters[name] = replace(glow, objects=tuple(o for o in glow.objects if o in things))
    for material in {material for material, _ in theirs}:
        left = [o for o, materials in worn.items() if material in materials]
        regions[material] = "subject" if any(scene.objects[o] == "subject" for o in left) else "surroundings"
    luminance = scene.texture_luminance
    luminances = luminance | {n: luminance[m] for n in copies if (m := copied(n)[0]) in luminance}
    return replace(
        scene,
        materials=regions,
        object_materials=worn,
        looks=looks,
        emitters=emitters,
        glows=(*scene.glows, *(name for name in copies if copied(name)[0] in scene.glows)),
        texture_luminance=luminances,
        copies={name: tuple(things) for name, things in copies.items()},
    )


def _split(look: MaterialLook, things: list[str]) -> tuple[MaterialLook, MaterialLook]:
    """The look of some objects' material and that of all others; what it is by its shape goes with the larger part."""
    mine = {o: share for o, share in look.worn.items() if o in things}
    rest = {o: share for o, share in look.worn.items() if o not in mine}
    shares = sum(mine.values()), sum(rest.values())
    both = zip((mine, rest), shares, strict=True)
    one, other = (
        replace(
            look, share=share, worn=worn, structures=look.structures if share == max(shares) else frozenset()
        )
        for worn, share in both
    )
    return one, other
