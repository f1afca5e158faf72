# SPDX-License-Identifier: Apache-2.0
"""The noun that a look word is said of, where grammar leaves no doubt; one that the scene lacks paints nothing else ("teal water")."""

from __future__ import annotations

from collections.abc import Mapping

from .lexicon.languages import singular, thing_words
from .lexicon.vocabulary import Vocabulary
from .names import is_detail, name_words, parts
from .passage import STRUCTURES, Passage, is_object
from .scene import NounMention, materials_of
from .targets import MATTER, SURFACE, PromptPairs, TargetPair
from .types import SceneDescription

_NO_MATTER = ("light", "fill", "rim", "sky", "fog", "shadow")
"""Kinds of nouns without a surface."""
_STOPS = ("around", "comparison", "exception")
"""Lists of words over which a look is not said of the noun before them: "a cup on red"."""
_MAIN = 0.6  # share of the subject from which one material is what a name for the subject means


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
        return self._purpose(look) or self._after(look) or self._before(look) or self._ahead(look)

    def changed(self, look: int) -> NounMention | None:
        """The object of the change phrase that a look word is in, or that it goes on with: "from red to grey, still glossy"."""
        return self.of(look) if self._change(look) else None

    def is_noun(self, look: int) -> bool:
        """Whether a color stands as a noun itself, and speaks of what is there: "out of the black"."""
        definite = look > 0 and self._items[look - 1].text == "the"
        return definite and not (self._items[look].change or self._after(look))

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

    def _ahead(self, look: int) -> NounMention | None:
        """The noun of "roof: red", which is all that the clause before says."""
        clause = self._items[look].clause
        before = self._in_clause(clause - 1)
        if any(self._noun(p) for p in self._in_clause(clause)) or not self._looks.isdisjoint(before):
            return None
        nouns = [noun for p in before if (noun := self._noun(p))]
        said = [p for p in before if not self._items[p].filler]
        return nouns[-1] if nouns and len({n.start for n in nouns}) == len(said) <= 2 else None

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

    Args:
        scene: Its names, and how its materials look.
    """

    def __init__(self, found: PromptPairs, scene: SceneDescription, vocabulary: Vocabulary) -> None:
        self._found, self._scene, self._vocabulary = found, scene, vocabulary
        self._own = OwnNouns(found.passage, found.mentions, vocabulary)
        self._subject = self._subject_name()

    def noun_of(self, pair: TargetPair) -> str:
        """The absent object that a look word describes; "" where it describes none."""
        own = self._own_of(pair)
        return own.text if own and own.text != self._subject and self._is_absent(own) else ""

    def is_astray(self, pair: TargetPair) -> bool:
        """Whether a word that is said of light or the like would paint an object: "a yellow beam on the rug", "out of the black"."""
        look = pair.look
        if pair.target.kind not in MATTER or pair.sense.slot == "material":
            return False
        if look.token.color and not (pair.names_itself or look.negated) and self._own.is_noun(look.index):
            return True
        own = self._own_of(pair)
        return own is not None and own.noun in _NO_MATTER and not own.named and own.start > look.index

    def _own_of(self, pair: TargetPair) -> NounMention | None:
        """The noun that a word about surfaces is said of."""
        token = pair.look.token
        slot = "color" if token.color else self._vocabulary.slot(token.entry) or pair.sense.slot
        return self._own.of(pair.look.index) if slot in SURFACE else None

    def _is_absent(self, noun: NounMention) -> bool:
        """Whether a noun names an object, and none in the scene."""
        words, looks = self._vocabulary.words, bool(self._scene.looks)
        if noun.named or not self._scene.materials:
            return False
        if noun.noun == "surroundings":
            shaped = any(noun.text in words[kind] for kind in STRUCTURES)
            return shaped and looks and len(materials_of("surroundings", self._scene)) != 1
        if noun.noun == "subject":
            return noun.text not in words["whole"] and looks and not self._is_of_one_material()
        return noun.noun == "unknown"

    def _subject_name(self) -> str:
        """The name that the prompt gives a subject whose names do not tell: the only object that it describes; "" for none."""
        mentions = self._found.mentions
        nouns = [noun for look in self._found.passage.looks if (noun := self._own.of(look.index))]
        absent = [noun for noun in nouns if self._is_absent(noun) and noun.noun == "unknown"]
        names = {noun.text for noun in absent} - self._vocabulary.words["scenery"]
        if len(names) != 1 or any(m.members > 1 and m.covers(n.start) for m in mentions for n in absent):
            return ""
        theirs = {name for m in mentions for n in m.named if n.kind == "things" for name in n.names}
        named = any(m.noun == "subject" for m in mentions) or not theirs.isdisjoint(
            materials_of("subject", self._scene)
        )
        return "" if named or self._has_a_name() or not self._is_of_one_material() else names.pop()

    def _has_a_name(self) -> bool:
        """Whether the subject's objects are called what they are, so that nobody calls it otherwise."""
        scene = self._scene
        general = frozenset[str]().union(*map(name_words, ("primitives", "limbs", "details", "pipeline")))
        things = thing_words().rows.keys() - general
        names: list[Mapping[str, str]] = [scene.objects, scene.materials]
        mine = (name for some in names for name, region in some.items() if region == "subject")
        named = any(word in things for name in mine for word in parts(name))
        return named and bool(scene.looks) and len(scene.materials) > 1

    def _is_of_one_material(self) -> bool:
        """Whether the subject is of one material, or nearly so; where only names are known it may be."""
        mine = [n for n in materials_of("subject", self._scene) if not is_detail(n)]
        looks = [look for name in mine if (look := self._scene.looks.get(name))]
        if not looks or len(mine) < 2:
            return True
        main = max(looks, key=lambda look: look.share)
        return not main.structures and main.share > _MAIN * sum(look.share for look in looks)
