# SPDX-License-Identifier: Apache-2.0
"""What the tokens of a clause do: they name things, describe what was named, link and separate."""

from __future__ import annotations

from dataclasses import replace

from ..schema.spec import Region
from .binding import Binder
from .clause import ClauseState
from .lexicon.vocabulary import Vocabulary
from .roles import KIND_OF_SLOT, Roles, light_role
from .things import Thing, Word
from .tokens import Token

_PICTURES = ("shot", "photo", "photography", "render", "advert", "commercial", "packshot", "shoot")
"""What colors before it describe is not the light: "white product shot"."""
_PLACES = ("in", "into", "at", "under", "beneath", "by", "amid")


class Actions:
    """Changes the state of a clause, token by token, and binds its look words.

    Args:
        vocabulary: What is known.
        binding: Collects what is bound.
        roles: Judges tokens by their neighbors.
        subject: What the scene calls its subject.

    Attributes:
        subject: What the prompt calls the subject, if nobody knows the word.
    """

    def __init__(self, vocabulary: Vocabulary, binding: Binder, roles: Roles, subject: str) -> None:
        self.vocabulary, self.binding, self.roles, self.subject = vocabulary, binding, roles, subject

    def connect(self, state: ClauseState, token: Token, following: Token | None) -> None:
        """A small word between others: what waits is bound, barred, or goes on to what follows."""
        if token.text in ("and", "or", "then", "yet", "also"):
            if state.bare and state.last and following and (following.noun or following.scene):
                # "the wall red and the cup blue"
                state.waiting = self.binding.bind(state.waiting, state.last)
            for word in state.waiting:
                word.barred = True
            state.negated = state.negated and token.text == "or"
        elif "joiner" in token.lists:
            self.flush(state)
            state.linked = state.around = state.inside = state.negated = state.bare = False
        elif "link" in token.lists and not (token.text == "in" and not state.last and not state.waiting):
            toned = following is not None and following.noun in ("shadow", "highlight", "tone")
            if not (state.last or toned):  # "blue in the shadows" is a color of theirs
                self.flush(state)
            elif state.last and token.text == "in" and not toned:  # "the wall teal in warm light"
                state.waiting = self.binding.bind(state.waiting, state.last)
            state.linked, state.inside = True, token.text == "in"
        else:
            self.flush(state)
            # "A wall behind a blue vase": of the two, the vase is the subject.
            before = token.text in ("behind", "beyond") and state.last and state.last.kind == "surroundings"
            state.linked, state.inside = False, token.text == "in"
            state.around = not before and not state.inside

    def apply(self, state: ClauseState, token: Token, following: Token | None) -> None:
        """A word about the whole picture; those that wait before it may describe it: "cool blue fog"."""
        entry = token.entry
        silhouette = entry == "silhouette"
        pictured = token.text.rpartition(" ")[2] in _PICTURES
        kind = token.noun or KIND_OF_SLOT.get(self.binding.slot(entry), "")
        kind = "" if silhouette or pictured else kind
        if pictured:  # "bright product shot"
            tones = [w for w in state.waiting if w.token.adjective and not w.token.color]
            state.waiting = [w for w in state.waiting if w not in tones]
            self.binding.bind(tones, Thing("whole", region="whole"), final=True)
        role = light_role(token)
        if kind == "light" and self.binding.directs_light(entry) and not role:
            role = (light_role(following) if following else "") or (state.last.role if state.last else "")
        thing = Thing(kind or "whole", token.text, "subject" if silhouette else "whole", role=role)
        apart = token.text.partition(" ")[0] in _PLACES  # "a white temple at night"
        if kind and not apart and not (following and following.noun and not token.noun):
            # first, as "cold" says more than "morning"
            state.waiting = self.binding.bind(state.waiting, thing)
        self.binding.add(state.word(token), entry, thing)
        if token.noun or (kind == "light" and not state.last):
            state.last, state.linked, state.bare = thing, False, False

    def noun(self, state: ClauseState, token: Token) -> None:
        """A word for a kind of thing: what waits describes it."""
        kind = token.noun
        regions: dict[str, Region] = {
            "surroundings": "surroundings",
            "sky": "surroundings",
            "subject": "subject",
        }
        thing = Thing(kind, token.text, regions.get(kind, "whole"), role=light_role(token))
        absent = self.vocabulary.absent.get(kind, "") if state.negated and not state.waiting else ""
        if absent and not token.entry:
            said = " ".join([*(state.prefix or ["no"]), token.text])
            self.binding.add(Word(token, said, 1.0, False), absent, thing)
        own = state.word(token) if token.entry else None
        if kind in regions:
            self.binding.things.append(thing)
        self._arrive(state, thing)
        if own:  # last, as "dim" says more than "museum"
            self.binding.add(own, token.entry, thing)

    def scene_name(self, state: ClauseState, token: Token) -> None:
        """A name of something in the scene: what waits describes it, and of several things each in turn."""
        assert token.scene
        kind: Region = "surroundings" if token.scene.region == "surroundings" else "subject"
        thing = Thing(kind, token.text, kind, token.scene.materials)
        colors = [w for w in state.waiting if w.token.color]
        if token.scene.several and 1 < len(colors) <= len(thing.owners):  # "red and blue chairs"
            state.waiting = [w for w in state.waiting if not w.token.color]
            for i, word in enumerate(colors):
                self.binding.bind([word], replace(thing, owners=thing.owners[i :: len(colors)]))
        self.binding.things.append(thing)
        self._arrive(state, thing)

    def _arrive(self, state: ClauseState, thing: Thing) -> None:
        """A noun: what waits describes it."""
        state.bare = not (state.waiting or state.linked or state.around or state.inside)
        state.waiting = self.binding.bind(state.waiting, thing)
        if state.linked and state.last:
            state.waiting = self.binding.bind(state.waiting, state.last)
        if thing.kind == "light" and (self.binding.attributes or self.binding.things):
            # "Dark walls, a brass lamp": better no brass than a brass something else.
            made = [w for w in state.waiting if self.binding.is_material(w) and not w.barred]
            state.waiting = [w for w in state.waiting if w not in made]
            self.binding.ignored += [w.text for w in made]
        state.last, state.linked, state.around, state.inside = thing, False, False, False
        state.prefix, state.strength = [], 1.0

    def unknown(self, state: ClauseState, token: Token, following: Token | None) -> None:
        """A word that nobody knows: a name for the subject or for a thing around it, or nothing."""
        before_look = following is not None and following.known and not following.lists
        if following and following.text.partition(" ")[0] in _PLACES:  # "letters in the dark": they are there
            before_look = False
        named = any(t.kind == "subject" for t in self.binding.things)
        if before_look or (state.prefix and not state.waiting) or token.text[0].isdigit():
            self.binding.ignored.append(token.text)
        elif state.around or state.inside:
            self._name(state, token.text, "surroundings")
        elif state.linked and state.last and state.waiting:
            self._arrive(state, state.last)  # "a slide of a yellow taxi", "a ring of copper wire"
        elif not named:
            self.subject = token.text
            self._name(state, token.text, "subject")
        else:
            # "A red fish" where no fish is, "the wheels are chrome": better no red than a red something else.
            self.binding.ignored += [token.text, *(w.text for w in state.waiting if not state.linked)]
            state.waiting = state.waiting if state.linked else []
            if following is None and not state.linked:
                state.last, state.bare = Thing("nowhere", token.text), False

    def _name(self, state: ClauseState, name: str, region: Region) -> None:
        thing = Thing(region, name, region)
        self.binding.things.append(thing)
        self._arrive(state, thing)

    def flush(self, state: ClauseState) -> None:
        """What waits cannot describe anything that comes later."""
        if state.waiting:
            slots = [self.binding.slot(w.token.entry) for w in state.waiting if w.token.entry]
            around = state.around or ("setting" in slots and (state.inside or not state.last))  # "red temple"
            self.binding.bind_rest(state.waiting, state.last, state.linked or state.bare, around)
        state.waiting = []
