# SPDX-License-Identifier: Apache-2.0
"""Change phrases: "the roof from red to slate", "teal instead of pink", "swap the navy surface for oak".

The present look in such a phrase is no wish: it tells which object is meant.
"""

from __future__ import annotations

import re
from dataclasses import replace

from ..lexicon.spelling import singular
from ..lexicon.things import thing_words
from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token

_LETTERS = {
    "V": "changes", "P": "paints", "S": "exchanges", "J": "becoming", "f": "leaving", "t": "reaching", "w": "exchanged",
    "I": "instead", "R": "former", "b": "rather", "O": "one", "v": "particles", "G": "gradients",
}  # fmt: skip
"""Letter of a token -> row of [grammar.words] that has it. Others: L a look of a surface, N an object, K a light, the sky or
the like, d "the", _ fillers and ties, . anything else."""
_A, _B, _X = "(?P<a>L+)", "(?P<b>L+)", "(?P<x>N+)"
_PATTERNS = [
    re.compile(pattern)
    for pattern in (
        f"(?:V[^LNK]*)?{_X}[^LNK]*?f[d_]*{_A}t[d_]*{_B}",  # "change the roof from red to grey"
        f"^[^LNK]*V[^LNK]*f[d_]*{_A}t[d_]*{_B}(?:[_d]*{_X})?",  # "go from red to grey on the roof"
        f"S[d_]*{_A}[^LNK]*?[wt][d_w]*{_B}[_d]*{_X}",  # "swap the cyan glow for orange on the rings"
        f"S[d_]*{_A}(?:[^LNK]*{_X})?[^LK]*?[wt][d_w]*{_B}O?",  # "swap the navy surface for oak"
        f"[VP][d_]*{_A}(?:[^LNK]*{_X})?[^LK]*?t[d_]*{_B}O?",  # "turn the purple ground into a pale mint"
        f"[VP](?:.*?_)??[_d]*{_A}{_X}(?:[._][^LVK]*?)?(?<!d){_B}(?!N)",  # "make the red chair blue"
        f"[VP]_*d{_A}(?:[._][^LVK]*?)?(?<!d){_B}(?!N)",  # "turn the black plastic between the stickers shiny"
        f"d{_A}{_X}[^LNK]*?J[d_]*{_B}(?!N)",  # "the red roof becomes grey"
        f"(?:{_X}[^LNK]*)?R[d_]*{_A}_*b[d_]*{_B}",  # "the roof is no longer red but grey"
        f"{_B}{_X}[^LK]*?I[d_]*{_A}O?",  # "a grey roof instead of a red one"
        f"(?:{_X}[^LNK]*)?{_B}[^LNK]*?I[d_]*{_A}O?",  # "the roof grey instead of red"
        f"(?:{_X}[^LNK]*)?I[d_]*(?P<a>L){_B}",  # "the roof, instead of red, grey"
    )
]
_MOST = 4  # changes in one clause
_SAID = "VSftwIRbOv"
"""Letters of tokens that only make a change phrase."""


def with_changes(clauses: list[list[Token]], vocabulary: Vocabulary) -> list[list[Token]]:
    """Clauses without present looks: those are with the objects that have them, see `Token.presents`.

    Args:
        clauses: Tokens of each clause, as the lexer gives them.
    """
    return [_changed(number, tokens, vocabulary) for number, tokens in enumerate(clauses, start=1)]


def is_object(token: Token, vocabulary: Vocabulary) -> bool:
    """Whether a word names an object: one of the scene, of a kind with a surface, or of the list of things."""
    if token.noun:
        return token.noun in ("surroundings", "subject")
    word = singular(token.text)
    structure = any(token.text in vocabulary.words[kind] for kind in STRUCTURES)
    return token.scene or structure or (word in thing_words().rows and not token.known)


STRUCTURES = ("ground", "support", "wall", "roof", "ceiling")
"""Rows of [grammar.words]: what parts of a scene are called that its names hardly ever say."""


def _changed(clause: int, tokens: list[Token], vocabulary: Vocabulary) -> list[Token]:
    """A clause with all of its changes, one after the other: "make the red door blue and the white wall grey"."""
    for number in range(_MOST):
        letters = "".join(_letter(token, vocabulary) for token in tokens)
        found = filter(None, (pattern.search(letters) for pattern in _PATTERNS))
        match = next((match for match in found if _is_a_change(tokens, match)), None)
        if match is None or "G" in letters:
            break
        tokens = _applied(clause * _MOST + number, tokens, match)
    return tokens


def _is_a_change(tokens: list[Token], match: re.Match[str]) -> bool:
    """Whether a phrase says more than "make red chair glossy", in which both looks are wished, and than "make the leather red"."""
    present, wished = (tokens[slice(*match.span(part))] for part in "ab")
    colored = any(token.color for token in present)
    done = any(token.change for token in (*present, *wished))
    if done or not (colored or _named(match) or "I" in match[0]):
        return False
    says_so = not set("df_tSIRJ").isdisjoint(match.string[match.start() : match.start("b")])
    return says_so or (colored and any(token.color for token in wished))


def _named(match: re.Match[str]) -> bool:
    """Whether a noun says which object a change is about."""
    return match.groupdict().get("x") is not None


def _letter(token: Token, vocabulary: Vocabulary) -> str:
    for letter, kind in _LETTERS.items():
        if token.text in vocabulary.words[kind]:
            return letter
    if is_object(token, vocabulary):
        return "N"
    if token.color or vocabulary.slot(token.entry) in ("color", "finish", "material"):
        return "L"
    if "definite" in token.lists:
        return "d"
    if token.noun and token.noun not in ("tone", "glow"):
        return "K"
    return "_" if token.noun or token.filler or token.ties or token.strength else "."


def _applied(number: int, tokens: list[Token], match: re.Match[str]) -> list[Token]:
    """A clause in which an object has its present looks, and what is wished of it is tied to it."""
    looks = tuple(tokens[place] for place in range(*match.span("a")))
    named, colored = _named(match), any(look.color for look in looks)
    owner = match.end("x") - 1 if named else match.end("a") - 1
    number = number if named or colored else 0
    found = []
    for place, token in enumerate(tokens):
        if place == owner and number:
            noun = token.noun or "unknown"  # that of a look too: "the lawn", "the black plastic"
            found.append(Token(token.text, scene=token.scene, noun=noun, presents=looks, change=number))
        elif match.start("b") <= place < match.end("b"):
            found.append(replace(token, change=number))
        elif not (match.start("a") <= place < match.end("a") or _only_says(place, match)):
            found.append(token)
    return found


def _only_says(place: int, match: re.Match[str]) -> bool:
    return match.start() <= place < match.end() and match.string[place] in _SAID
