# SPDX-License-Identifier: Apache-2.0
"""Binds the look words of a prompt by fitted weights."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from functools import cached_property

from ...schema import VibeError
from ..keyed import KeyedSpan
from ..lexicon.entries import VocabularyEntry
from ..lexicon.rigs import TIMES, rig_table
from ..lexicon.vocabulary import Vocabulary
from ..meaning import NamedThing
from ..mentions.light_phrases import light_phrases
from ..mentions.passage import PromptLook
from ..shading import shaded
from ..types import STRONGEST, WEAKEST, Attribute, Parsed, SceneDescription
from .absent import AbsentObjects
from .assignment import assigned, probabilities
from .becoming import becoming
from .bound import Thing, Things
from .model import scores, shipped_weights
from .pairs import PromptPairs, TargetPair, looks, reading
from .targets import LAMPS, MATTER, NOWHERE, TINGE
from .told import ToldTargets, told_thing

_PLAIN = "Use plain look words that the vocabulary knows."
_UNSURE = 0.35
"""Probability that a word is no look from which it is not used; chosen on a half of tests/prompt/ordinary_words.toml."""
_LESS = 0.7  # how much of the opposite "less" asks for


class PromptReader:
    """Scores every look word with everything that it may describe, and takes what is likeliest together.

    Args:
        weights: By feature; None for those that are shipped.
        is_part: What is read is what a mood stands for; no mood may be in it.
        told: Word -> what the artist says that it describes.
        english: Word -> the same in English, where the artist's prompt is in another language.

    Attributes:
        mentioned: The nouns with a surface: name, region and materials.
        subject: What the prompt, or the scene, calls the subject.
        beyond: Words of a picture that no value could give.
        undone: Wishes that values cannot fulfill.
        lacking: Says which words describe objects that the scene lacks.
        found: The pairs of the prompt.
        chosen: The pair of each of its look words.
        absent: The pairs of words whose object the scene lacks, by id.
        unused: Numbers of the look words that are left out.
    """

    def __init__(
        self,
        vocabulary: Vocabulary,
        scene: SceneDescription,
        weights: Mapping[str, float] | None = None,
        is_part: bool = False,
        told: Mapping[str, str] | None = None,
        english: Mapping[str, str] | None = None,
    ) -> None:
        self.vocabulary, self.scene, self.is_part = vocabulary, scene, is_part
        self._given = told or {}, english or {}
        self.weights = shipped_weights() if weights is None else weights
        self.subject = scene.subject
        self.mentioned: list[NamedThing] = []
        self.beyond: list[str] = []
        self.undone: list[str] = []
        self.lacking: list[str] = []

    def read(self, text: str, foreign: Collection[str] = (), keyed: Collection[KeyedSpan] = ()) -> Parsed:
        """Binds every look word; the result lacks what `meaning.complete` adds.

        Args:
            foreign: Words of another language that are left in it.
            keyed: What it says of things that it sets before with a colon.

        Raises:
            VibeError: The scene has nothing of a name that was told.
        """
        told, english = self._given
        self.told = ToldTargets(
            told, self.scene, self.vocabulary, english, self._after_keys(text, foreign, keyed)
        )
        self.found: PromptPairs = reading(text, self.scene, self.vocabulary, foreign)
        self._phrases = light_phrases(self.found.passage, self.vocabulary, rig_table())
        bound = zip(assigned(self.found, self.weights), self.found.pairs, strict=True)
        self.chosen: list[TargetPair] = self.told.bound(self._where_it_stands(*each) for each in bound)
        things = Things(self.found, self.chosen, self.scene)
        parsed, self.absent = Parsed(text), self._without_object(things)
        self.unused: list[int] = []
        for number, pair in enumerate(self.chosen):
            said = self._told(pair, things) if pair.told else self._said(number, things)
            parsed.attributes += [replace(attribute, look=number) for attribute in said or ()]
            if said == []:
                self.unused.append(number)
                parsed.ignored.append(pair.look.text)
            elif said and pair.look.token.guess:
                parsed.guesses[pair.look.token.text] = pair.look.token.guess
        things.notes += [
            f"'{word}' is no look word here: its target is not used." for word in self.told.unused()
        ]
        passage = self.found.passage
        self.mentioned, self.subject, parsed.notes = things.mentioned, things.subject, things.notes
        self.beyond, self.undone = passage.beyond, [" ".join(words) for words in passage.wishes]
        parsed.ignored += [*(w for words in passage.wishes for w in words), *self.beyond, *self._unknown()]
        parsed.guesses |= dict(self._guessed_names())
        return parsed

    @cached_property
    def probabilities(self) -> list[list[tuple[TargetPair, float]]]:
        """The likeliest pairs of each look word with their probabilities, whatever the artist says."""
        return probabilities(self.found, self.weights)

    def _told(self, pair: TargetPair, things: Things) -> list[Attribute]:
        """What a look word says of what the artist has chosen for it; nothing where it is not to be used."""
        if pair.target.kind == "none":
            return []
        return [*self._attributes(pair.look, self._entry(pair, []), told_thing(pair, things.of(pair)), ())]

    def _said(self, number: int, things: Things) -> list[Attribute] | None:
        """What a look word says; nothing where it is not used, None where it is part of another word or of a name."""
        pair = self.chosen[number]
        look, kind, is_a_name = pair.look, pair.target.kind, self._is_a_name(pair.look.index)
        unsure = self._is_unsure(pair, self.found.pairs[number])
        if look.index in self._phrases.gone and kind not in MATTER:  # "replace the harsh lamp"
            return []
        if (kind == "none" or unsure) and self._is_a_light(look, things):
            return [_light(look, self._lights(look))]
        if kind == "light" and is_a_name and self._is_described(look, things):
            return None
        if id(pair) in self.absent or unsure:
            return []
        if kind in NOWHERE:
            return None if kind == TINGE or is_a_name else []
        entry = self._entry(pair, self.chosen[number + 1 : number + 2])
        said = self._attributes(look, entry, things.of(pair), self._lights(look))
        before = self.chosen[number - 1] if number else pair
        return [self._tinged(each, before.look) for each in said] if before.target.kind == TINGE else [*said]

    def _after_keys(
        self, text: str, foreign: Collection[str], keyed: Collection[KeyedSpan]
    ) -> dict[int, str]:
        """Number of each look word after a key -> the key."""

        def count(end: int) -> int:
            return len(looks(text[:end], self.scene, self.vocabulary, foreign).looks)

        return {number: span.name for span in keyed for number in range(count(span.start), count(span.end))}

    def _lights(self, look: PromptLook) -> tuple[int, ...]:
        """The numbers of the lights in whose description a word stands."""
        return self._phrases.of.get(look.index, ())

    def _where_it_stands(self, pair: TargetPair, pairs: list[TargetPair]) -> TargetPair:
        """A word with the target that its place leaves no doubt of: in the description of a light, or right before fog."""
        return self._of_its_light(pair, pairs) if self._lights(pair.look) else self._of_its_air(pair, pairs)

    def _of_its_light(self, pair: TargetPair, pairs: list[TargetPair]) -> TargetPair:
        """A word in the description of a light, said of light unless it tells of something that is named there: "a pink one"."""
        mention = pair.target.mention
        if mention >= 0:
            noun = self.found.mentions[mention]
            here = self._phrases.of.get(noun.start) == self._lights(pair.look)
            picks = any(word in self.vocabulary.picks for word in noun.text.split())
            side = here and picks  # "a pink one at the left"
            stays = here if pair.target.kind in LAMPS else not side
        else:
            matter = pair.target.kind in MATTER or (pair.target.kind == "picture" and pair.look.token.color)
            may_turn = pair.look.token.color or pair.look.token.adjective
            stays = not (matter and may_turn) or self._is_definite(pair.look)
        role = self._phrases.role(pair.look.index)
        if stays and not (role and pair.target.kind == "light"):
            return pair
        return next((other for other in pairs if other.target.kind == (role or "light")), pair)

    def _of_its_air(self, pair: TargetPair, pairs: list[TargetPair]) -> TargetPair:
        """A color right before fog, smoke or the like, said of that: "greenish ground fog"."""
        items, place = self.found.passage.items, pair.look.index + 1
        following = next((item for item in items[place:] if item.strength is None), None)
        if following is None or following.clause != items[place - 1].clause or not pair.look.token.color:
            return pair
        air = following.noun == "fog" or self.vocabulary.slot(following.entry) == "atmosphere"
        return next((other for other in pairs if other.target.kind == "air"), pair) if air else pair

    def _is_definite(self, look: PromptLook) -> bool:
        """Whether a word that could be a thing is spoken of as one: "the candle is red"."""
        before = self.found.passage.items[look.index - 1 : look.index]
        return any(item.text in self.vocabulary.lists["definite"] for item in before)

    def _is_unsure(self, pair: TargetPair, pairs: list[TargetPair]) -> bool:
        """Whether a word may as well be none that speaks of a look, and no noun says what it describes."""
        if pair.target.mention >= 0 or pair.target.kind not in (*MATTER, "picture") or len(self.chosen) == 1:
            return False
        likely = zip(scores(pairs, self.weights), pairs, strict=True)
        return sum(math.exp(score) for score, each in likely if each.target.kind == "none") > _UNSURE

    def _without_object(self, things: Things) -> set[int]:
        """The pairs of words whose object the scene lacks, by id; the notes get a sentence for each object."""
        objects, lacking = AbsentObjects(self.found, self.scene, self.vocabulary), defaultdict(list)
        for pair in self.chosen:
            if pair.told:
                continue
            if noun := objects.noun_of(pair):
                lacking[noun].append(pair)
        for noun, pairs in lacking.items():
            said = ", ".join(f"'{pair.look.text}'" for pair in pairs)
            self.lacking.append(f"{said}: there is no '{noun}' in the scene; not used.")
        things.notes += self.lacking
        absent = {id(pair) for pairs in lacking.values() for pair in pairs}
        return absent | {id(pair) for pair in self.chosen if objects.is_astray(pair)}

    def _tinged(self, attribute: Attribute, look: PromptLook) -> Attribute:
        """A color with the shade that a word before it says."""
        alone = becoming(look.token, "things", self.vocabulary)
        entry = alone.entry if alone else ""
        return shaded(attribute, look.text, entry, look.strength, self.vocabulary)

    def _is_a_name(self, index: int) -> bool:
        """Whether a word that could be a look names a thing of the scene: a pier where there is one."""
        return any(m.named and m.covers(index) for m in self.found.mentions)

    def _is_a_light(self, look: PromptLook, things: Things) -> bool:
        """Whether a word that seems to name a thing is a source of light that a rig is for: "a single candle on the left"."""
        rig = rig_table().rigs.get(look.token.entry)
        if rig is None or rig.kind not in ("source", *TIMES) or rig.adds or look.token.guess:
            return False
        if self._is_definite(look) and "thing" in look.token.lists:
            return False
        return not (self._is_described(look, things) or self._is_a_name(look.index))

    def _is_described(self, look: PromptLook, things: Things) -> bool:
        """Whether a word is the thing that other words describe: the fire of "blue fire"."""
        others = (pair for pair in self.chosen if pair.look is not look and pair.target.kind != "none")
        return any(look.token.text in things.of(pair).thing.split() for pair in others)

    def _entry(self, pair: TargetPair, after: list[TargetPair]) -> str:
        """What a look word becomes; of "emerald velvet" the emerald is the color of the next material."""
        token, becoming = pair.look.token, pair.becoming
        own = token.name or token.text
        if after and token.color and becoming.slot == after[0].becoming.slot == "material":
            return own if after[0].look.index == pair.look.index + 1 else becoming.entry
        return becoming.entry or own

    def _attributes(
        self, word: PromptLook, entry: str, thing: Thing, phrases: tuple[int, ...]
    ) -> Iterator[Attribute]:
        """What a look word says of a thing; a mood brings what it stands for."""
        known = self.vocabulary.entries.get(entry)
        if known and word.less and known.opposite and known.slot != "atmosphere":  # less fog is still fog
            entry, word = known.opposite, replace(word, strength=_LESS)
            known = self.vocabulary.entries[entry]
        yield Attribute(
            word=word.text,
            entry=entry,
            slot=known.slot if known else "color",
            strength=word.strength,
            negated=word.negated,
            color=None if known else word.token.color,
            guess=bool(word.token.guess),
            shades=word.token.shades if known else (),
            phrases=phrases,
            **vars(thing),
        )
        for part in self._stands_for(known) if known and known.means and not word.negated else ():
            strength = min(max(part.strength * word.strength, WEAKEST), STRONGEST)
            guess = bool(word.token.guess)
            yield replace(part, cause=word.text, strength=strength, guess=guess, phrases=())

    def _stands_for(self, mood: VocabularyEntry) -> Iterator[Attribute]:
        """What a mood brings: the parts of its row `means`, each read by itself and without a scene."""
        if self.is_part:
            raise VibeError(f"Vocabulary: '{mood.name}', for which a mood stands, is a mood itself.", _PLAIN)
        for part in mood.means.split(","):
            reader = PromptReader(self.vocabulary, SceneDescription(), self.weights, is_part=True)
            attributes = reader.read(part).attributes
            if not attributes:
                what = f"'{part.strip()}', for which '{mood.name}' stands, is no look."
                raise VibeError(f"Vocabulary: {what}", _PLAIN)
            yield from attributes

    def _unknown(self) -> Iterator[str]:
        """Words that name nothing that is known, and are no look either."""
        bound = {pair.look.index for pair in self.chosen if pair.target.kind != "none"}
        unknown = (m for m in self.found.mentions if m.noun == "unknown" and not m.named)
        yield from (m.text for m in unknown if m.start not in bound and m.text != self.subject)
        yield from (
            t.text for t in self.found.passage.items if t.unsure and not t.scene and not self._named(t.text)
        )
        yield from (t.text for t in self.found.passage.items if "count" in t.lists or t.text.isdigit())

    def _named(self, text: str) -> bool:
        """Whether a word names something of the scene."""
        return any(m.named and m.text == text for m in self.found.mentions)

    def _guessed_names(self) -> Iterator[tuple[str, str]]:
        """Words that are the name of a thing of the scene with a mistake."""
        for mention in self.found.mentions:
            named = next((n for n in mention.named if "object misspelled" in n.signs), None)
            if named and mention.members == 1:
                worn = self.scene.object_materials.items()
                yield mention.text, next(name for name, mats in worn if not named.names.isdisjoint(mats))


def _light(look: PromptLook, phrases: tuple[int, ...]) -> Attribute:
    """A word for a source of light, said of light as a whole."""
    return Attribute(
        look.text,
        look.token.entry,
        "lighting",
        "whole",
        "light",
        look.strength,
        look.negated,
        thing=look.token.text,
        phrases=phrases,
    )
