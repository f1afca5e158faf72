# SPDX-License-Identifier: Apache-2.0
"""Understands a prompt: which look words there are, and what each of them describes."""

from __future__ import annotations

import re
from dataclasses import replace

from ..schema import VibeError
from .binding import BOUND_SLOTS, Binding, Thing, Word
from .clause import ClauseState
from .english import ONLY_ENGLISH, other_language
from .lexer import Lexer, Token
from .meaning import complete
from .nearest import Guess
from .types import Parsed, Region, SceneWords
from .vocabulary import Vocabulary, default_vocabulary

LONGEST_PROMPT = 2000
_TAG = re.compile(r"</?[a-zA-Z][^<>]{0,200}>|\x1b\[[0-9;]*[A-Za-z]|[\x00-\x08\x0e-\x1f\x7f]")
_THINGS_STAY = "things are not added, moved or removed, only their look changes."
_AGAIN = ("make", "give", "keep", "set", "let")
"""A verb that starts a new wish: "remove the chair and make it warm"."""
_PLACES = ("in", "into", "at", "under", "beneath", "by", "amid")
_STYLE = (
    "look",
    "style",
    "styled",
    "mood",
    "vibe",
    "feel",
    "feeling",
    "aesthetic",
    "ambience",
    "tone",
    "effect",
    "finish",
)
_KIND_OF_SLOT = {"lighting": "light", "atmosphere": "fog", "grade": "tone", "setting": "surroundings"}


def parse(prompt: str, scene: SceneWords, vocabulary: Vocabulary | None = None) -> Parsed:
    """Finds the look words of a prompt and binds them to subject, surroundings, lights or the film.

    Raises:
        VibeError: The prompt is empty, too long, or holds no look word at all.
    """
    text = " ".join(_TAG.sub(" ", prompt).split())
    if not text:
        raise VibeError(
            "The prompt is empty.", "Describe a look, for example: 'glossy teal, white studio background'."
        )
    if len(text) > LONGEST_PROMPT:
        raise VibeError(f"The prompt has {len(text)} characters.", f"Say it in {LONGEST_PROMPT} or less.")
    foreign = other_language(text)
    if foreign == "all":
        raise VibeError(f"The prompt '{text[:60]}' is not in English.", ONLY_ENGLISH)
    reader = _Reader(vocabulary or default_vocabulary(), scene)
    parsed = reader.read(text)
    if reader.beyond:
        said = ", ".join(f"'{text}'" for text in dict.fromkeys(reader.beyond))
        parsed.conflicts.append(f"{said}: no value of a material, light, world, fog or film gives that.")
    if reader.undone:
        said = ", ".join(f"'{text}'" for text in dict.fromkeys(reader.undone))
        parsed.conflicts.append(f"{said}: {_THINGS_STAY}")
    if foreign:
        parsed.conflicts.append(f"Some of the prompt does not look like English. {ONLY_ENGLISH}")
    if not parsed.attributes:
        raise VibeError(
            f"Nothing in the prompt '{text[:60]}' names a look{' in English' if foreign else ''}"
            + (f": {_THINGS_STAY}" if reader.undone else "."),
            "Name colors (teal), materials (glossy, gold), light (warm soft light), fog, grading (noir, vignette) "
            "or a mood (cosy, ominous).",
        )
    things = [(t.name, t.region, t.owners) for t in reader.binding.things]
    complete(parsed, reader.vocabulary, reader.subject, things)
    return parsed


class _Reader:
    """Walks through the clauses of a prompt, token by token."""

    def __init__(self, vocabulary: Vocabulary, scene: SceneWords, cause: str = "") -> None:
        self.vocabulary, self.scene = vocabulary, scene
        self.lexer = Lexer(vocabulary, scene)
        self.binding = Binding(vocabulary, cause, self._means)
        self.subject = scene.subject
        self.guesses: dict[str, str] = {}
        self.confidence: dict[str, float] = {}
        self.beyond: list[str] = []
        self.undone: list[str] = []

    def read(self, text: str) -> Parsed:
        """Binds every clause; the result lacks what `meaning.complete` adds."""
        previous: Thing | None = None
        self.carried: list[Word] = []
        for tokens in self.lexer.clauses(text):
            previous = self._clause(tokens, previous)
        self.binding.bind_rest(self.carried, None, False, False)
        if not self.binding.cause:
            self.binding.tint_the_picture(several=_subjects(self.scene) > 1)
        return Parsed(
            text,
            attributes=self.binding.attributes,
            ignored=self.binding.ignored,
            guesses=self.guesses,
            confidence=self.confidence,
        )

    def _means(self, text: str, cause: str) -> Parsed:
        return _Reader(self.vocabulary, SceneWords(), cause).read(text)

    def _clause(self, tokens: list[Token], previous: Thing | None) -> Thing | None:
        state = ClauseState(waiting=self.carried)
        self.carried = []
        skipped = 0
        for index, token in enumerate(tokens):
            rest = tokens[index + 1 :]
            if index < skipped:
                continue
            if token.near and self._may_be_look(token.near, state, rest):
                token.entry, token.guess, token.name = token.near.entry, token.near.entry, token.near.near
                self.confidence[token.text] = token.near.confidence
            if token.guess:
                self.guesses[token.text] = token.guess
            if token.lists & {"action", "undo"}:
                ends = (i for i, t in enumerate(rest) if t.lists & {"action", "undo"} or t.text in _AGAIN)
                until = next(ends, len(rest))
                if not _speaks_of_looks(rest[:until]):
                    skipped = index + 1 + until
                    left = tokens[index:skipped]
                    wish = [t.text for t in left if not t.lists & {"stop", "joiner"}]
                    self.binding.ignored += wish
                    self.undone.append(" ".join(wish))
                    continue
                state.negated = "undo" in token.lists
            else:
                self._step(state, token, rest)
        # "The wall, painted yellow": a clause that starts by a link goes on about the last thing.
        state.last = state.last or (previous if state.linked else None)
        if not (state.last or state.around):
            # "Soft, slightly warm light": adjectives that may yet find the noun that they need.
            self.carried = [replace(w, barred=True) for w in state.waiting if _is_adjective(w.token)]
            state.waiting = [w for w in state.waiting if not _is_adjective(w.token)]
        self._flush(state)
        return state.last or previous

    def _step(self, state: ClauseState, token: Token, rest: list[Token]) -> None:
        following = _next_content(rest)
        look = token.entry or token.color
        if "beyond" in token.lists:
            self.binding.ignored += [*(w.text for w in state.waiting), token.text]
            self.beyond.append(token.text)
            state.waiting, state.prefix = [], []
        elif token.scene and (not look or (state.waiting and not following)):
            self._scene_name(state, token)
        elif token.strength is not None and self._is_intensity(token, following):
            state.strength *= token.strength
            state.prefix.append(token.text)
        elif "negation" in token.lists:
            state.negated = True
            state.prefix.append(token.text)
        elif token.lists & {"around", "link", "joiner"} and not token.entry:
            self._connect(state, token, following)
        elif self._is_global(token) and not (
            token.adjective and (self._describes(token, following) or self._goes_on(token, state, following))
        ):
            self._apply(state, token, following)
        elif token.noun and not (token.adjective and following and (following.noun or following.color)):
            self._noun(state, token)
        elif look or token.adjective:
            state.linked |= bool(token.adjective) and self._goes_on(token, state, following)
            state.waiting.append(state.word(token))
        elif "count" in token.lists:
            self.binding.ignored.append(token.text)
        elif not token.lists:
            self._unknown(state, token, following)

    # ---- what a token is

    def _may_be_look(self, near: Guess, state: ClauseState, rest: list[Token]) -> bool:
        """Whether an unknown word stands where a look word can: a matter, only where something is made of it."""
        if not near.noun:
            return True
        following = rest[0] if rest else None
        styled = following is not None and following.text in _STYLE
        describes = following is not None and bool(following.noun or following.scene or not following.known)
        return (state.linked and state.last is not None and not state.inside) or styled or describes

    def _is_global(self, token: Token) -> bool:
        """Whether it describes the whole picture."""
        return bool(token.entry) and self.binding.slot(token.entry) not in BOUND_SLOTS

    def _is_intensity(self, token: Token, following: Token | None) -> bool:
        """Whether "strong" strengthens the next look word, or is itself one ("strong light")."""
        if not token.adjective:
            return True
        if not following:
            return False
        if following.noun and (following.noun != "light" or not following.entry):
            return following.noun not in self.vocabulary.adjectives[token.adjective]
        return not (following.entry and self.binding.directs_light(following.entry))

    def _describes(self, token: Token, following: Token | None) -> bool:
        """Whether an adjective that is also a word of its own describes what follows."""
        if not following:
            return False
        if following.color or (following.entry and self.binding.slot(following.entry) in BOUND_SLOTS):
            return True
        kind = following.noun or ("subject" if following.scene else "")
        return kind in self.vocabulary.adjectives[token.adjective]

    def _goes_on(self, token: Token, state: ClauseState, following: Token | None) -> bool:
        """Whether an adjective is said of the noun before it: "the background is bright", "the wall less dark"."""
        return (
            state.last is not None
            and state.last.matter
            and (state.linked or following is None)
            and state.last.kind in self.vocabulary.adjectives[token.adjective]
        )

    # ---- what it does

    def _connect(self, state: ClauseState, token: Token, following: Token | None) -> None:
        if token.text in ("and", "or", "then", "yet", "also"):
            for word in state.waiting:
                word.barred = True
            state.negated = state.negated and token.text == "or"
        elif "joiner" in token.lists:
            self._flush(state)
            state.linked = state.around = state.inside = state.negated = False
        elif "link" in token.lists and not (token.text == "in" and not state.last and not state.waiting):
            toned = following is not None and following.noun in ("shadow", "highlight", "tone")
            if not (state.last or toned):  # "blue in the shadows" is a color of theirs
                self._flush(state)
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
        kind = "" if silhouette else token.noun or _KIND_OF_SLOT.get(self.binding.slot(entry), "")
        role = _role(token)
        if kind == "light" and self.binding.directs_light(entry) and not role:
            role = (_role(following) if following else "") or (state.last.role if state.last else "")
        thing = Thing(kind or "whole", token.text, "subject" if silhouette else "whole", role=role)
        self.binding.add(state.word(token), entry, thing)
        if kind and not (following and following.noun and not token.noun):
            state.waiting = self.binding.bind(state.waiting, thing)
        if token.noun or (kind == "light" and not state.last):
            state.last, state.linked = thing, False

    def _noun(self, state: ClauseState, token: Token) -> None:
        kind = token.noun
        regions: dict[str, Region] = {
            "surroundings": "surroundings",
            "sky": "surroundings",
            "subject": "subject",
        }
        thing = Thing(kind, token.text, regions.get(kind, "whole"), role=_role(token))
        absent = self.vocabulary.absent.get(kind, "") if state.negated and not state.waiting else ""
        if absent and not token.entry:
            said = " ".join([*(state.prefix or ["no"]), token.text])
            self.binding.add(Word(token, said, 1.0, False), absent, thing)
        elif token.entry:
            self.binding.add(state.word(token), token.entry, thing)
        if kind in regions:
            self.binding.things.append(thing)
        self._arrive(state, thing)

    def _scene_name(self, state: ClauseState, token: Token) -> None:
        assert token.scene
        kind: Region = "surroundings" if token.scene.region == "surroundings" else "subject"
        thing = Thing(kind, token.text, kind, token.scene.materials)
        self.binding.things.append(thing)
        self._arrive(state, thing)

    def _arrive(self, state: ClauseState, thing: Thing) -> None:
        """A noun: what waits describes it."""
        state.waiting = self.binding.bind(state.waiting, thing)
        if state.linked and state.last:
            state.waiting = self.binding.bind(state.waiting, state.last)
        state.last, state.linked, state.around, state.inside = thing, False, False, False
        state.prefix, state.strength = [], 1.0

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
                state.last = Thing("nowhere", token.text)

    def _name(self, state: ClauseState, name: str, region: Region) -> None:
        thing = Thing(region, name, region)
        self.binding.things.append(thing)
        self._arrive(state, thing)

    def _flush(self, state: ClauseState) -> None:
        """What waits cannot describe anything that comes later."""
        if state.waiting:
            self.binding.bind_rest(state.waiting, state.last, state.linked, state.around)
        state.waiting = []


def _subjects(scene: SceneWords) -> int:
    return sum(region == "subject" for region in scene.objects.values())


def _is_adjective(token: Token) -> bool:
    """Whether a word means nothing by itself: "soft", but not "glossy" or "teal"."""
    return bool(token.adjective) and not (token.entry or token.color)


def _role(token: Token) -> str:
    """The light that a noun means: "key light" the key, "light" light in general ("")."""
    if token.noun in ("fill", "rim"):
        return token.noun
    return "key" if {"key", "keylight", "main"} & set(token.text.split()) else ""


def _next_content(tokens: list[Token]) -> Token | None:
    """The next token that is not merely an article or an intensity; None at a connective."""
    for token in tokens:
        if token.lists & {"joiner", "link", "around"} and not token.entry:
            return None
        if "stop" not in token.lists and (token.strength is None or token.adjective):
            return token
    return None


def _speaks_of_looks(tokens: list[Token]) -> bool:
    """Whether an action is about light, fog or the like, rather than about things."""
    if not all(t.known and "count" not in t.lists for t in tokens):
        return False
    return any(t.entry or t.noun in ("light", "fill", "rim", "fog") for t in tokens)
