# SPDX-License-Identifier: Apache-2.0
"""Walks through the clauses of a prompt and binds their look words."""

from __future__ import annotations

from dataclasses import replace

from .actions import Actions
from .binding import Binder
from .clause import ClauseState
from .lexicon.vocabulary import Vocabulary
from .meaning import NamedThing
from .roles import (
    Roles,
    is_adjective,
    is_the_thing,
    likened,
    listed,
    next_content,
    speaks_of_looks,
    submerged,
)
from .things import Thing, Word
from .tokens import Lexer, Token
from .types import Parsed, SceneWords

_AGAIN = ("make", "give", "keep", "set", "let")
"""A verb that starts a new wish: "remove the chair and make it warm"."""


class PromptReader:
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
        self.binding = Binder(vocabulary, cause, self._means)
        self.roles = Roles(vocabulary, self.binding)
        self.act = Actions(vocabulary, self.binding, self.roles, scene.subject)
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

    @property
    def subject(self) -> str:
        """What the prompt, or the scene, calls the subject."""
        return self.act.subject

    @property
    def mentioned(self) -> list[NamedThing]:
        """The nouns met."""
        return [(t.name, t.region, t.owners) for t in self.binding.things]

    def _means(self, text: str, cause: str) -> Parsed:
        return PromptReader(self.vocabulary, SceneWords(), cause).read(text)

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
        self.act.flush(state)
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
            self.act.scene_name(state, token)
        elif token.strength is not None and self.roles.is_intensity(token, following):
            state.strength *= token.strength
            state.prefix.append(token.text)
        elif "negation" in token.lists:
            state.negated = True
            state.prefix.append(token.text)
        elif token.lists & {"around", "link", "joiner"} and not token.entry:
            self.act.connect(state, token, following)
        elif self.roles.is_global(token) and not (
            (
                token.adjective
                and (self.roles.describes(token, following) or self.roles.goes_on(token, state, following))
            )
            or (token.color and following is not None and (following.noun or following.scene))
        ):
            self.act.apply(state, token, following)
        elif token.noun and not (token.adjective and following and (following.noun or following.color)):
            self.act.noun(state, token)
        elif look or token.adjective:
            state.linked |= bool(token.adjective) and self.roles.goes_on(token, state, following)
            state.waiting.append(state.word(token))
        elif "count" in token.lists:
            self.binding.ignored.append(token.text)
        elif not token.lists:
            self.act.unknown(state, token, following)


def _subjects(scene: SceneWords) -> int:
    return sum(region == "subject" for region in scene.objects.values())
