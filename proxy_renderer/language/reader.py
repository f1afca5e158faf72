# SPDX-License-Identifier: Apache-2.0
"""Walks through the clauses of a prompt and binds their look words."""

from __future__ import annotations

from dataclasses import replace

from .binding import Binding, Thing, Word
from .clause import ClauseState
from .lexer import Lexer, Token
from .roles import (
    KIND_OF_SLOT,
    Roles,
    is_adjective,
    is_the_thing,
    light_role,
    likened,
    listed,
    next_content,
    speaks_of_looks,
    submerged,
)
from .types import Parsed, Region, SceneWords
from .vocabulary import Vocabulary

_AGAIN = ("make", "give", "keep", "set", "let")
"""A verb that starts a new wish: "remove the chair and make it warm"."""
_PICTURES = ("shot", "photo", "photography", "render", "advert", "commercial", "packshot", "shoot")
"""What colors before it describe is not the light: "white product shot"."""
_PLACES = ("in", "into", "at", "under", "beneath", "by", "amid")


class Reader:
    """Walks through the clauses of a prompt, token by token.

    Args:
        vocabulary: What is known.
        scene: The names in the scene.
        cause: The mood that the text stands for; "" for the prompt itself.
        things: Whether words that stand for moods may be the things themselves: "a gold castle".

    Attributes:
        named: Whether some were.
    """

    def __init__(
        self, vocabulary: Vocabulary, scene: SceneWords, cause: str = "", things: bool = True
    ) -> None:
        self.vocabulary, self.scene = vocabulary, scene
        self.lexer = Lexer(vocabulary, scene)
        self.binding = Binding(vocabulary, cause, self._means)
        self.roles = Roles(vocabulary, self.binding)
        self.subject = scene.subject
        self.things, self.named = things and not cause, False
        self.guesses: dict[str, str] = {}
        self.confidence: dict[str, float] = {}
        self.beyond: list[str] = []
        self.undone: list[str] = []

    def read(self, text: str) -> Parsed:
        """Binds every clause; the result lacks what `meaning.complete` adds."""
        previous: Thing | None = None
        self.carried: list[Word] = []
        for tokens in submerged(listed(self.lexer.clauses(text)), self.vocabulary):
            previous = self._clause(tokens, previous)
        self.binding.bind_rest(self.carried, None, False, False)
        if not self.binding.cause:
            self.binding.unclaimed.share_out(several=_subjects(self.scene) > 1)
        return Parsed(
            text,
            attributes=self.binding.attributes,
            ignored=self.binding.ignored,
            guesses=self.guesses,
            confidence=self.confidence,
        )

    def _means(self, text: str, cause: str) -> Parsed:
        return Reader(self.vocabulary, SceneWords(), cause).read(text)

    def _clause(self, tokens: list[Token], previous: Thing | None) -> Thing | None:
        state = ClauseState(waiting=self.carried)
        self.carried = []
        skipped = 0
        for index, token in enumerate(tokens):
            rest = tokens[index + 1 :]
            if index < skipped:
                continue
            if token.near and self.roles.may_be_look(token.near, state, rest):
                token.entry, token.guess, token.name = token.near.entry, token.near.entry, token.near.near
                self.confidence[token.text] = token.near.confidence
            if token.guess:
                self.guesses[token.text] = token.guess
            if token.lists & {"action", "undo"}:
                ends = (i for i, t in enumerate(rest) if t.lists & {"action", "undo"} or t.text in _AGAIN)
                until = next(ends, len(rest))
                if not speaks_of_looks(rest[:until]):
                    skipped = index + 1 + until
                    left = tokens[index:skipped]
                    wish = [t.text for t in left if not t.lists & {"stop", "joiner"}]
                    self.binding.ignored += wish
                    self.undone.append(" ".join(wish))
                    continue
                state.negated = "undo" in token.lists
            else:
                skipped = index + 1 + likened(tokens, index)
                self._step(state, token, rest)
                state.definite = token.text == "the"
        # "The wall, painted yellow": a clause that starts by a link goes on about the last thing.
        state.last = state.last or (previous if state.linked else None)
        if not (state.last or state.around):
            # "Soft, slightly warm light": adjectives that may yet find the noun that they need.
            self.carried = [replace(w, barred=True) for w in state.waiting if is_adjective(w.token)]
            state.waiting = [w for w in state.waiting if not is_adjective(w.token)]
        self._flush(state)
        return state.last or previous

    def _step(self, state: ClauseState, token: Token, rest: list[Token]) -> None:
        following = next_content(rest)
        if self.things and self.roles.is_thing(token, state, rest):
            token = replace(token, entry="", noun="", adjective="", lists=frozenset())
            self.named = True
        look = token.entry or token.color
        if "beyond" in token.lists:
            self.binding.ignored += [*(w.text for w in state.waiting), token.text]
            self.beyond.append(token.text)
            state.waiting, state.prefix = [], []
        elif token.scene and (not look or (state.waiting and not following) or is_the_thing(state, rest)):
            self._scene_name(state, token)
        elif token.strength is not None and self.roles.is_intensity(token, following):
            state.strength *= token.strength
            state.prefix.append(token.text)
        elif "negation" in token.lists:
            state.negated = True
            state.prefix.append(token.text)
        elif token.lists & {"around", "link", "joiner"} and not token.entry:
            self._connect(state, token, following)
        elif self.roles.is_global(token) and not (
            (
                token.adjective
                and (self.roles.describes(token, following) or self.roles.goes_on(token, state, following))
            )
            or (token.color and following is not None and (following.noun or following.scene))
        ):
            self._apply(state, token, following)
        elif token.noun and not (token.adjective and following and (following.noun or following.color)):
            self._noun(state, token)
        elif look or token.adjective:
            state.linked |= bool(token.adjective) and self.roles.goes_on(token, state, following)
            state.waiting.append(state.word(token))
        elif "count" in token.lists:
            self.binding.ignored.append(token.text)
        elif not token.lists:
            self._unknown(state, token, following)

    # ---- what a token does

    def _connect(self, state: ClauseState, token: Token, following: Token | None) -> None:
        if token.text in ("and", "or", "then", "yet", "also"):
            if state.bare and state.last and following and (following.noun or following.scene):
                state.waiting = self.binding.bind(
                    state.waiting, state.last
                )  # "the wall red and the cup blue"
            for word in state.waiting:
                word.barred = True
            state.negated = state.negated and token.text == "or"
        elif "joiner" in token.lists:
            self._flush(state)
            state.linked = state.around = state.inside = state.negated = state.bare = False
        elif "link" in token.lists and not (token.text == "in" and not state.last and not state.waiting):
            toned = following is not None and following.noun in ("shadow", "highlight", "tone")
            if not (state.last or toned):  # "blue in the shadows" is a color of theirs
                self._flush(state)
            elif state.last and token.text == "in" and not toned:  # "the wall teal in warm light"
                state.waiting = self.binding.bind(state.waiting, state.last)
            state.linked, state.inside = True, token.text == "in"
        else:
            self._flush(state)
            # "A wall behind a blue vase": of the two, the vase is the subject.
            before = token.text in ("behind", "beyond") and state.last and state.last.kind == "surroundings"
            state.linked, state.inside = False, token.text == "in"
            state.around = not before and not state.inside

    def _apply(self, state: ClauseState, token: Token, following: Token | None) -> None:
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
            state.waiting = self.binding.bind(
                state.waiting, thing
            )  # first, as "cold" says more than "morning"
        self.binding.add(state.word(token), entry, thing)
        if token.noun or (kind == "light" and not state.last):
            state.last, state.linked, state.bare = thing, False, False

    def _noun(self, state: ClauseState, token: Token) -> None:
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

    def _scene_name(self, state: ClauseState, token: Token) -> None:
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
            made = [w for w in state.waiting if self._is_material(w)]
            state.waiting = [w for w in state.waiting if w not in made]
            self.binding.ignored += [w.text for w in made]
        state.last, state.linked, state.around, state.inside = thing, False, False, False
        state.prefix, state.strength = [], 1.0

    def _is_material(self, word: Word) -> bool:
        return (
            bool(word.token.entry) and self.binding.slot(word.token.entry) == "material" and not word.barred
        )

    def _unknown(self, state: ClauseState, token: Token, following: Token | None) -> None:
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

    def _flush(self, state: ClauseState) -> None:
        """What waits cannot describe anything that comes later."""
        if state.waiting:
            slots = [self.binding.slot(w.token.entry) for w in state.waiting if w.token.entry]
            around = state.around or ("setting" in slots and (state.inside or not state.last))  # "red temple"
            self.binding.bind_rest(state.waiting, state.last, state.linked or state.bare, around)
        state.waiting = []


def _subjects(scene: SceneWords) -> int:
    return sum(region == "subject" for region in scene.objects.values())
