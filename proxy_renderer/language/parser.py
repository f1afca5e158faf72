# SPDX-License-Identifier: Apache-2.0
"""Understands a prompt: which look words there are, and what each of them describes."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from ..schema import VibeError
from .lexer import Lexer, SceneName, Token
from .meaning import complete
from .types import Attribute, Parsed, Region, SceneWords
from .vocabulary import Vocabulary, default_vocabulary

LONGEST_PROMPT = 2000
_BOUND_SLOTS = ("finish", "material", "color", "setting")
"""Slots whose words wait for the noun that they describe; the others describe the whole picture."""
_KIND_OF_SLOT = {"lighting": "light", "atmosphere": "fog", "grade": "tone", "setting": "surroundings"}
_ROLES = ("fill", "rim")


@dataclass
class _Thing:
    """What words are bound to."""

    kind: str
    name: str = ""
    region: Region = "subject"
    owners: tuple[str, ...] = ()
    role: str = ""


@dataclass
class _Word:
    """A look word that waits for its noun."""

    token: Token
    text: str
    strength: float
    negated: bool
    barred: bool = False  # an "and" came after it


@dataclass
class _Clause:
    """What is known at one point of a clause."""

    waiting: list[_Word] = field(default_factory=list)
    last: _Thing | None = None
    linked: bool = False
    around: bool = False
    inside: bool = False  # "in": what follows lies around the subject only if it is a thing
    strength: float = 1.0
    negated: bool = False
    prefix: list[str] = field(default_factory=list)


def parse(prompt: str, scene: SceneWords, vocabulary: Vocabulary | None = None) -> Parsed:
    """Finds the look words of a prompt and binds them to subject, surroundings, lights or the film.

    Raises:
        VibeError: The prompt is empty, too long, or holds no look word at all.
    """
    text = " ".join(prompt.split())
    if not text:
        raise VibeError("The prompt is empty.", "Describe a look, for example: 'glossy teal, white studio background'.")
    if len(text) > LONGEST_PROMPT:
        raise VibeError(f"The prompt has {len(text)} characters.", f"Say it in {LONGEST_PROMPT} or less.")
    vocabulary = vocabulary or default_vocabulary()
    binder = Binder(vocabulary, scene, text)
    binder.read(text)
    if not binder.parsed.attributes:
        raise VibeError(
            f"Nothing in the prompt '{text[:60]}' names a look.",
            "Name colors (teal), materials (glossy, gold), light (warm soft light), fog, grading (noir, vignette) "
            "or a mood (cosy, ominous).",
        )
    complete(binder.parsed, vocabulary, binder.subject, [(t.name, t.region, t.owners) for t in binder.things])
    return binder.parsed


class Binder:
    """Walks through the clauses of a prompt and collects attributes in `parsed`."""

    def __init__(self, vocabulary: Vocabulary, scene: SceneWords, prompt: str, cause: str = "") -> None:
        self.vocabulary, self.scene, self.cause = vocabulary, scene, cause
        self.lexer = Lexer(vocabulary, scene if not cause else SceneWords())
        self.parsed = Parsed(prompt)
        self.subject = scene.subject
        self.things: list[_Thing] = []

    def read(self, text: str) -> None:
        """Binds every clause."""
        previous: _Thing | None = None
        for tokens in self.lexer.clauses(text):
            previous = self._clause(tokens, previous)

    def _clause(self, tokens: list[Token], previous: _Thing | None) -> _Thing | None:
        state = _Clause()
        index = 0
        while index < len(tokens):
            token, rest = tokens[index], tokens[index + 1 :]
            if token.guess:
                self.parsed.guesses[token.text] = token.guess
            if token.lists & {"action", "undo"}:
                if not _speaks_of_looks(rest):
                    self.parsed.ignored += [t.text for t in tokens[index:] if "stop" not in t.lists]
                    break
                state.negated = "undo" in token.lists
            else:
                self._step(state, token, rest)
            index += 1
        else:
            # "The wall, painted yellow": a clause that starts by a link goes on about the last thing.
            if state.linked and not state.last:
                state.last = previous
        self._flush(state)
        return state.last or previous

    def _step(self, state: _Clause, token: Token, rest: list[Token]) -> None:
        following = _next_content(rest)
        if token.scene and not (token.entry or token.color) or token.scene and not following and state.waiting:
            self._arrive(state, self._scene_thing(token.scene))
        elif token.strength is not None and self._is_intensity(token, following):
            state.strength *= token.strength
            state.prefix.append(token.text)
        elif "negation" in token.lists:
            state.negated = True
            state.prefix.append(token.text)
        elif token.lists & {"around", "link", "joiner"} and not token.entry:
            self._connect(state, token)
        elif token.entry and self.vocabulary.entries[token.entry].slot not in _BOUND_SLOTS and not (
            token.adjective and self._resolves(token, following)
        ):
            self._apply(state, token, following)
        elif token.noun and not (token.adjective and following and (following.noun or following.color)):
            self._noun(state, token)
        elif token.entry or token.color or token.adjective:
            state.waiting.append(self._word(state, token))
        elif not token.lists:
            self._unknown(state, token, following)

    # ---- single steps

    def _is_intensity(self, token: Token, following: Token | None) -> bool:
        """Whether "strong" strengthens the next look word, or is itself one ("strong light")."""
        if not token.adjective:
            return True
        if not following:
            return False
        if following.noun and (following.noun != "light" or not following.entry):
            return following.noun not in self.vocabulary.adjectives[token.adjective]
        return not (following.entry and self._directs_light(following.entry))

    def _directs_light(self, entry: str) -> bool:
        return any(e.name in ("azimuth", "elevation") and not e.weak for e in self.vocabulary.entries[entry].effects) and (
            "light" in self.vocabulary.entries[entry].slot
        )

    def _resolves(self, token: Token, following: Token | None) -> bool:
        """Whether an adjective that is also a word of its own describes what follows."""
        if not following:
            return False
        if following.color or (following.entry and self.vocabulary.entries[following.entry].slot in _BOUND_SLOTS):
            return True
        return (following.noun or ("subject" if following.scene else "")) in self.vocabulary.adjectives[token.adjective]

    def _connect(self, state: _Clause, token: Token) -> None:
        if "joiner" in token.lists:
            if token.text in ("and", "or", "then", "yet", "also"):
                for word in state.waiting:
                    word.barred = True
                state.negated = state.negated and token.text == "or"
            else:
                self._flush(state)
                state.linked = state.around = state.inside = state.negated = False
            return
        if "link" in token.lists and not (token.text == "in" and not state.last and not state.waiting):
            if state.waiting and not state.last:
                self._flush(state)
            state.linked, state.inside = True, token.text in ("in", "of")
            return
        self._flush(state)
        state.linked, state.around, state.inside = False, token.text != "in", token.text == "in"

    def _word(self, state: _Clause, token: Token) -> _Word:
        prefix = state.prefix if state.prefix or not state.negated else ["no"]
        word = _Word(token, " ".join([*prefix, token.text]), state.strength, state.negated)
        state.prefix, state.strength = [], 1.0
        return word

    def _apply(self, state: _Clause, token: Token, following: Token | None) -> None:
        """A word about the whole picture; those that wait before it may describe it: "cool blue fog"."""
        entry = self.vocabulary.entries[token.entry]
        kind = token.noun or _KIND_OF_SLOT.get(entry.slot, "")
        if token.entry == "silhouette":
            kind = ""
        word = self._word(state, token)
        role = _role(token)
        if kind == "light" and self._directs_light(entry.name) and not role:
            role = (_role(following) if following else "") or (state.last.role if state.last else "")
        region: Region = "subject" if token.entry == "silhouette" else "whole"
        thing = _Thing(kind or "whole", token.text, region, role=role)
        self._add(word, entry.name, thing, entry.slot)
        if kind and state.waiting and not (following and following.noun and not token.noun):
            state.waiting = self._bind(state.waiting, thing)
        if kind and (token.noun or not state.last):
            state.last = thing if token.noun or kind == "light" else state.last
        state.linked = state.linked and not token.noun

    def _noun(self, state: _Clause, token: Token) -> None:
        kind = token.noun
        region: Region = "surroundings" if kind in ("surroundings", "sky") else "subject" if kind == "subject" else "whole"
        thing = _Thing(kind, token.text, region, role=_role(token))
        if token.entry:
            self._add(self._word(state, token), token.entry, thing, self.vocabulary.entries[token.entry].slot)
        if kind in ("surroundings", "subject", "sky"):
            self.things.append(thing)
        self._arrive(state, thing)

    def _scene_thing(self, scene: SceneName) -> _Thing:
        kind = "surroundings" if scene.region == "surroundings" else "subject"
        owners = scene.materials
        thing = _Thing(kind, scene.name, kind, owners)  # type: ignore[arg-type]
        self.things.append(thing)
        return thing

    def _arrive(self, state: _Clause, thing: _Thing) -> None:
        """A noun: what waits describes it."""
        state.waiting = self._bind(state.waiting, thing)
        if state.linked and state.waiting and state.last:
            state.waiting = self._bind(state.waiting, state.last)
        state.last, state.linked, state.around, state.inside = thing, False, False, False
        state.prefix, state.strength = [], 1.0

    def _unknown(self, state: _Clause, token: Token, following: Token | None) -> None:
        """A word that nobody knows: a name for the subject or for a thing around it, or nothing."""
        modifies = following and (following.entry or following.color or following.noun or following.scene or following.adjective)
        if (modifies and following and not following.lists) or state.prefix and not state.waiting:
            self.parsed.ignored.append(token.text)
            return
        if state.around or state.inside:
            thing = _Thing("surroundings", token.text, "surroundings")
            self.things.append(thing)
            self._arrive(state, thing)
        elif not self.subject or not any(t.kind == "subject" for t in self.things) and not self.scene.objects:
            self.subject = self.subject or token.text
            thing = _Thing("subject", token.text, "subject")
            self.things.append(thing)
            self._arrive(state, thing)
        else:
            self.parsed.ignored.append(token.text)
            if state.waiting and not state.linked:
                self.parsed.ignored += [w.text for w in state.waiting]
                state.waiting = []

    # ---- binding

    def _flush(self, state: _Clause) -> None:
        """The end of a clause: what still waits describes the last noun, the surroundings, or the subject."""
        if state.waiting:
            if state.around:
                thing = _Thing("surroundings", "surroundings", "surroundings")
            elif state.linked and state.last:
                thing = state.last
            elif state.last and state.last.kind not in ("subject", "surroundings") and not _has_color(state.waiting):
                thing = state.last
            else:
                thing = _Thing("subject", "subject", "subject")
            left = self._bind(state.waiting, thing)
            self._bind(left, _Thing("subject", "subject", "subject"), final=True)
        state.waiting = []

    def _bind(self, words: list[_Word], thing: _Thing, final: bool = False) -> list[_Word]:
        """Binds words to a thing; returns those that do not describe such a thing."""
        left = []
        for position, word in enumerate(words):
            followed = any(not w.barred and w.token.color for w in words[position:])
            matter = thing.kind in ("subject", "surroundings")
            if word.barred and not matter and not (word.token.color and followed) and not word.token.adjective:
                left.append(word)
            elif not self._bind_word(word, thing):
                if final:
                    self.parsed.ignored.append(word.text)
                left.append(word)
        return left

    def _bind_word(self, word: _Word, thing: _Thing) -> bool:
        token = word.token
        kinds = self.vocabulary.adjectives.get(token.adjective, {})
        matter = thing.kind in ("subject", "surroundings")
        painted = thing.kind in self.vocabulary.painted
        if thing.kind in kinds:
            self._add_adjective(word, kinds[thing.kind], thing)
        elif token.entry and matter and self.vocabulary.entries[token.entry].slot in _BOUND_SLOTS:
            slot = self.vocabulary.entries[token.entry].slot
            where = thing if slot != "setting" else _Thing("surroundings", region="surroundings")
            self._add(word, token.entry, where, slot)
        elif token.color and painted:
            self._add(word, token.guess or token.text, thing, "color")
        elif token.color and thing.kind == "whole":
            return False
        elif "otherwise" in kinds:
            self._add_adjective(word, kinds["otherwise"], thing)
        elif token.entry and not matter and self.vocabulary.entries[token.entry].slot == "setting":
            self._add(word, token.entry, _Thing("surroundings", region="surroundings"), "setting")
        else:
            return False
        return True

    def _add_adjective(self, word: _Word, entry: str, thing: _Thing) -> None:
        slot = self.vocabulary.entries[entry].slot
        if slot == "setting":
            thing = replace(thing, kind="surroundings", region="surroundings") if thing.kind != "surroundings" else thing
        elif slot not in ("finish", "material", "color"):
            thing = replace(thing, region="whole", owners=())
        self._add(word, entry, thing, slot)

    def _add(self, word: _Word, entry: str, thing: _Thing, slot: str) -> None:
        color = word.token.color if slot == "color" and entry not in self.vocabulary.entries else None
        attribute = Attribute(
            word.text,
            entry,
            slot,  # type: ignore[arg-type]
            thing.region,
            thing.kind,
            word.strength,
            word.negated,
            thing.owners,
            thing.role,
            color,
            thing.name,
            self.cause,
            bool(word.token.guess),
        )
        self.parsed.attributes.append(attribute)
        means = self.vocabulary.entries[entry].means if entry in self.vocabulary.entries else ""
        if means and not self.cause:
            self._expand(attribute, means)

    def _expand(self, mood: Attribute, means: str) -> None:
        """A mood stands for other words; "not gloomy" only keeps its picture away."""
        if mood.negated:
            return
        inner = Binder(self.vocabulary, SceneWords(), means, cause=mood.entry)
        inner.read(means)
        self.parsed.attributes += [replace(a, strength=a.strength * mood.strength) for a in inner.parsed.attributes]


def _role(token: Token) -> str:
    """The light that a noun means: "key light" the key, "light" light in general ("")."""
    if token.noun in _ROLES:
        return token.noun
    return "key" if {"key", "keylight", "main"} & set(token.text.split()) else ""


def _next_content(tokens: list[Token]) -> Token | None:
    """The next token that is not merely an article or an intensity."""
    for token in tokens:
        if not token.known:
            return token
        if "stop" in token.lists or (token.strength is not None and not token.adjective):
            continue
        if token.lists & {"joiner", "link", "around"} and not token.entry:
            return None
        return token
    return None


def _speaks_of_looks(tokens: list[Token]) -> bool:
    """Whether an action is about light, fog or the like, rather than about things."""
    looks = [t for t in tokens if t.known and not t.lists and t.strength is None]
    return bool(looks) and any(t.entry or t.noun in ("light", "fill", "rim", "fog") for t in looks) and all(
        t.known for t in tokens
    ) and not any("count" in t.lists for t in tokens)


def _has_color(words: list[_Word]) -> bool:
    return any(w.token.color for w in words)
