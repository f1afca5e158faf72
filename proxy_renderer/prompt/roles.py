# SPDX-License-Identifier: Apache-2.0
"""What a token is where it stands: a look, an intensity, an adjective of what follows, or the name of a thing."""

from __future__ import annotations

from dataclasses import replace

from .binding import Binder
from .clause import ClauseState
from .lexicon.nearest import Guess
from .lexicon.vocabulary import Vocabulary
from .tokens import Token
from .unclaimed import BOUND_SLOTS

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

KIND_OF_SLOT = {"lighting": "light", "atmosphere": "fog", "grade": "tone", "setting": "surroundings"}
"""What a word of a slot is about, where no noun says it."""


class Roles:
    """Judges tokens by their neighbors."""

    def __init__(self, vocabulary: Vocabulary, binding: Binder) -> None:
        self.vocabulary, self.binding = vocabulary, binding

    def may_be_look(self, near: Guess, state: ClauseState, rest: list[Token]) -> bool:
        """Whether an unknown word stands where a look word can: a matter, only where something is made of it."""
        if not near.noun:
            return True
        following = rest[0] if rest else None
        styled = following is not None and following.text in _STYLE
        describes = following is not None and bool(following.noun or following.scene or not following.known)
        return (state.linked and state.last is not None and not state.inside) or styled or describes

    def is_global(self, token: Token) -> bool:
        """Whether it describes the whole picture."""
        return bool(token.entry) and self.binding.slot(token.entry) not in BOUND_SLOTS

    def is_intensity(self, token: Token, following: Token | None) -> bool:
        """Whether "strong" strengthens the next look word, or is itself one ("strong light")."""
        if not token.adjective:
            return True
        if not following:
            return False
        if following.noun and (following.noun != "light" or not following.entry):
            return following.noun not in self.vocabulary.adjectives[token.adjective]
        return not (following.entry and self.binding.directs_light(following.entry))

    def describes(self, token: Token, following: Token | None) -> bool:
        """Whether an adjective that is also a word of its own describes what follows."""
        if not following:
            return False
        if following.color or (following.entry and self.binding.slot(following.entry) in BOUND_SLOTS):
            return True
        kind = following.noun or ("subject" if following.scene else "")
        slot = self.binding.slot(following.entry) if following.entry and not kind else ""
        if slot in ("lighting", "atmosphere"):  # "cold morning"
            kind = KIND_OF_SLOT[slot]
        return kind in self.vocabulary.adjectives[token.adjective]

    def goes_on(self, token: Token, state: ClauseState, following: Token | None) -> bool:
        """Whether an adjective is said of the noun before it: "the background is bright", but not "a cup in a dark garage"."""
        return (
            state.last is not None
            and state.last.matter
            and (following is None or (state.linked and not state.inside))
            and state.last.kind in self.vocabulary.adjectives[token.adjective]
        )

    def is_thing(self, token: Token, state: ClauseState, rest: list[Token]) -> bool:
        """Whether a word that may stand for a mood or a light is the thing itself: "a gold castle", "the candle is red".

        A mood is meant by "castle look", and a light by "candle" alone.
        """
        named = token.scene is not None or "thing" in token.lists
        placed = (state.around or state.inside) and not token.scene  # "in a castle"
        if not (named and self.is_global(token)) or placed:
            return False
        following = next_content(rest)
        if (rest and rest[0].text in _STYLE) or (
            following is not None and following.noun and not following.entry
        ):
            return False
        if token.scene or self.binding.slot(token.entry) != "lighting":
            return True
        described = any(w.token.color or w.token.entry for w in state.waiting)
        return described or bool(rest and "link" in rest[0].lists)


def is_adjective(token: Token) -> bool:
    """Whether a word means nothing by itself: "soft", but not "glossy" or "teal"."""
    return bool(token.adjective) and not (token.entry or token.color)


def light_role(token: Token) -> str:
    """The light that a noun means: "key light" the key, "light" light in general ("")."""
    if token.noun in ("fill", "rim"):
        return token.noun
    return "key" if {"key", "keylight", "main"} & set(token.text.split()) else ""


def next_content(tokens: list[Token]) -> Token | None:
    """The next token that is not merely an article or an intensity; None at a connective."""
    for token in tokens:
        if token.lists & {"joiner", "link", "around"} and not token.entry:
            return None
        if "stop" not in token.lists and (token.strength is None or token.adjective):
            return token
    return None


def speaks_of_looks(tokens: list[Token]) -> bool:
    """Whether an action is about light, fog or the like, rather than about things."""
    if not all(t.known and "count" not in t.lists for t in tokens):
        return False
    return any(t.entry or t.noun in ("light", "fill", "rim", "fog") for t in tokens)


def likened(tokens: list[Token], index: int) -> int:
    """How many tokens after this one only liken a look to something: "white as snow" is not made of snow."""
    after = tokens[index + 1 : index + 4]
    look = tokens[index].entry or tokens[index].color or tokens[index].adjective
    if not (look and after and after[0].text == "as"):
        return 0
    return 2 + (len(after) > 2 and after[1].text in ("a", "an", "the"))


def is_the_thing(state: ClauseState, rest: list[Token]) -> bool:
    """Whether a name that is also a look stands as the thing: "the lemon is ...", "the lemon more yellow"."""
    after = rest[0] if rest else None
    return state.definite and (after is None or "link" in after.lists or after.strength is not None)


def submerged(clauses: list[list[Token]], vocabulary: Vocabulary) -> list[list[Token]]:
    """The clauses; under water, "water" is what is all around, and nothing is made of it."""

    def is_under(token: Token) -> bool:
        entry = vocabulary.entries.get(token.entry)
        return bool(entry and entry.slot == "atmosphere" and "water" in entry.phrase)

    if not any(is_under(token) for tokens in clauses for token in tokens):
        return clauses
    return [
        [replace(t, entry="", noun="fog") if t.entry == "water" else t for t in tokens] for tokens in clauses
    ]


def listed(clauses: list[list[Token]]) -> list[list[Token]]:
    """The clauses; "red, green and blue balls" is one, where there are several balls."""
    found: list[list[Token]] = []
    for tokens in reversed(clauses):
        rest = found[0] if found else []
        link = next((t for t in rest[1:2] if t.text == "and"), None)
        several = any(t.scene and t.scene.several for t in rest)
        if len(tokens) == 1 and tokens[0].color and link and rest[0].color and several:
            found[0] = [*tokens, link, *rest]
        else:
            found.insert(0, tokens)
    return found
