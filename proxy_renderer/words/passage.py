# SPDX-License-Identifier: Apache-2.0
"""A prompt as a row of tokens, and its look words; "red" in "the roof from red to grey", a present look, is none."""

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from itertools import takewhile

from .lexer import Lexer, Token
from .lexicon.languages import singular, thing_words
from .lexicon.vocabulary import Vocabulary
from .types import STRONGEST, WEAKEST, SceneDescription

_WISHES = {"action", "undo"}
_ENDS = {*_WISHES, "again"}  # lists of words that end a wish
LIGHTS = ("light", "fill", "rim")  # kinds of nouns that are lights
STRUCTURES = ("floor", "walls", "ground", "support", "wall", "roof", "ceiling")
"""Rows of [grammar.words]: parts of a scene that are hardly ever in its names."""
_LETTERS = {
    "V": "changes", "P": "paints", "S": "exchanges", "J": "becoming", "f": "leaving", "t": "reaching", "w": "exchanged",
    "I": "instead", "R": "former", "b": "rather", "O": "one", "v": "particles", "G": "gradients",
}  # fmt: skip
"""Letter of a token in change phrases -> row of [grammar.words] that has it. Others: L a look of a surface, N an object, K a light,
the sky or the like, d "the", _ fillers and ties, . anything else."""
_A, _B, _X = "(?P<a>L+)", "(?P<b>L+)", "(?P<x>N+)"  # present looks, wished looks, and the object
_CHANGES = [
    re.compile(pattern)
    for pattern in (
        f"(?:V[^LNK]*)?{_X}[^LNK]*?f[d_]*{_A}t[d_]*{_B}",  # "change the roof from red to grey"
        f"S[d_]*{_A}[^LNK]*?[wt][d_w]*{_B}[_d]*{_X}",  # "swap the cyan glow for orange on the rings"
        f"S[d_]*{_A}(?:[^LNK]*{_X})?[^LK]*?[wt][d_w]*{_B}O?",  # "swap the navy surface for oak"
        f"S[d_]*{_X}{_A}[^LNK]*?[wt][d_w]*{_B}",  # the same where looks follow: "the car red"
        f"[VP][d_]*{_A}(?:[^LNK]*{_X})?[^LK]*?t[d_]*{_B}O?",  # "turn the purple ground into a pale mint"
        f"[VP](?:.*?_)??[_d]*{_A}{_X}(?:[._][^LVK]*?)?(?<!d){_B}(?!N)",  # "make the red chair blue"
        f"[VP]_*d{_A}(?:[._][^LVK]*?)?(?<!d){_B}(?!N)",  # "turn the black plastic between the stickers shiny"
        f"d{_A}{_X}[^LNK]*?J[d_]*{_B}(?!N)",  # "the red roof becomes grey"
        f"(?:{_X}[^LNK]*)?R[d_]*{_A}_*b[d_]*{_B}",  # "the roof is no longer red but grey"
        f"{_B}{_X}[^LK]*?I[d_]*{_A}O?",  # "a grey roof instead of a red one"
        f"(?:{_X}[^LNK]*)?{_B}[^LNK]*?I[d_]*{_A}O?",  # "the roof grey instead of red"
    )
]
_MOST = 4  # changes in one clause
_SAID = "VSftwIRbOv"  # letters of tokens that only make a change phrase


@dataclass(frozen=True)
class PromptLook:
    """A look word of a prompt, with the intensities and negations before it."""

    index: int  # its place among the tokens
    token: Token
    text: str  # as the prompt says it, with its intensity and negation
    strength: float  # of the intensities before it
    negated: bool

    @property
    def less(self) -> bool:
        """True for "less ...": the image is to have less of the look than now."""
        return "less" in self.text.removesuffix(self.token.text).split()  # no phrase such as "less contrast"


@dataclass
class Passage:
    """A prompt's tokens and look words."""

    items: list[Token]  # all tokens, with the numbers of their clauses
    looks: list[PromptLook] = field(default_factory=list)  # the look words, in order
    starts: set[int] = field(default_factory=set)  # places of tokens that begin a clause as written
    wishes: list[list[str]] = field(default_factory=list)  # words of each request to add, move or remove objects
    beyond: list[str] = field(default_factory=list)  # words for what no parameter changes: "blurry"

    def content(self, start: int, end: int) -> list[Token]:
        """The tokens from `start` to before `end` that are no fillers."""
        return [item for item in self.items[max(start, 0) : end] if not item.filler]


def passage(text: str, words: SceneDescription, vocabulary: Vocabulary, foreign: Collection[str] = ()) -> Passage:
    """The tokens and look words of a prompt, not bound yet; `foreign`: words of another language that are in it."""
    found = Passage([])
    for number, tokens in enumerate(Lexer(vocabulary, words, foreign).clauses(text)):
        start = len(found.items)
        found.starts.add(start)
        found.items += _without_wishes(number, _with_changes(number, tokens, vocabulary), found)
        found.looks += _looks(found, start, vocabulary)
    found.beyond = [i.text for i in found.items if "beyond" in i.lists]
    return found


def _without_wishes(number: int, tokens: list[Token], found: Passage) -> Iterator[Token]:
    """Yields the tokens of clause `number`; those of a request to add, move or remove objects are marked as `wished`.

    A request about looks, light or fog is not marked. Words of marked requests are added to `found.wishes`.
    """
    until = 0
    for index, token in enumerate(tokens):
        if token.lists & _WISHES:
            objects = [*takewhile(lambda t: not t.lists & _ENDS, tokens[index + 1 :])]
            about_looks = any(t.entry or t.noun in (*LIGHTS, "fog") for t in objects)
            if not (about_looks and all(t.known and "count" not in t.lists for t in objects)):
                until = index + 1 + len(objects)
                found.wishes.append([t.text for t in tokens[index:until] if not t.lists & {"stop", "joiner"}])
        elif "focus" in token.lists:  # "focus on the cup" wishes nothing of the cup
            until = len(tokens)
        yield replace(token, clause=number, wished=index < until)


def _looks(found: Passage, start: int, vocabulary: Vocabulary) -> Iterator[PromptLook]:
    """Yields the look words of the clause that begins at token `start`, with their intensities and negations."""
    prefix: list[str] = []
    strength, negated = 1.0, False
    for index, token in enumerate(found.items[start:], start):
        if token.wished or "beyond" in token.lists:
            continue
        following = next(iter(found.content(index + 1, len(found.items))), None)
        absent = negated and token.noun in vocabulary.absent and not token.entry  # "no shadows" is a look too
        before_a_look = following and following.names_a_look
        if token.strength is not None and (before_a_look or not token.names_a_look):  # no "strong light"
            strength = min(max(strength * token.strength, WEAKEST), STRONGEST)
            prefix.append(token.text)
        elif token.lists & {"negation", "undo"}:
            negated = True
            prefix.append(token.text)
        elif absent or token.names_a_look:
            look = replace(token, entry=vocabulary.absent[token.noun], noun="") if absent else token
            text = " ".join([*(prefix if prefix or not negated else ["no"]), token.text])
            yield PromptLook(index, look, text, strength, negated and not absent)
            prefix, strength = [], 1.0
        elif token.ties or token.lists & {"action"}:
            negated = negated and "either" in token.lists
        elif not token.filler:
            prefix, strength = [], 1.0


def is_object(token: Token, vocabulary: Vocabulary) -> bool:
    """True if a word names an object: one of the scene, of a kind with a surface, or of the list of things."""
    if token.noun:
        return token.noun in ("surroundings", "subject")
    structure = any(token.text in vocabulary.words[kind] for kind in STRUCTURES)
    return token.scene or structure or (singular(token.text) in thing_words() and not token.known)


def _with_changes(clause: int, tokens: list[Token], vocabulary: Vocabulary) -> list[Token]:
    """The tokens of a clause; objects of changes ("the roof from red to grey") get `presents`, their present looks."""
    for number in range(1, _MOST + 1):  # "make the red door blue and the white wall grey"
        letters = "".join(_letter(token, vocabulary) for token in tokens)
        matches = filter(None, (pattern.search(letters) for pattern in _CHANGES))
        match = next((match for match in matches if _is_a_change(tokens, match)), None)
        if match is None or "G" in letters:
            break
        tokens = _changed(clause * _MOST + number, tokens, match)
    return tokens


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


def _is_a_change(tokens: list[Token], match: re.Match[str]) -> bool:
    """True if a match replaces a present look.

    In "make red chair glossy" both looks are wished, and "make the leather red" has no present look.
    """
    present, wished = (tokens[slice(*match.span(part))] for part in "ab")
    colored = any(token.color for token in present)
    done = any(token.change for token in (*present, *wished))
    if done or not (colored or match.groupdict().get("x") is not None or "I" in match[0]):
        return False
    says_so = not set("df_tSIRJ").isdisjoint(match.string[match.start() : match.start("b")])
    return says_so or (colored and any(token.color for token in wished))


def _changed(number: int, tokens: list[Token], match: re.Match[str]) -> list[Token]:
    """The tokens of a clause after one change: the object gets `presents`; object and wished looks get `number`."""
    looks = tuple(tokens[place] for place in range(*match.span("a")))
    named = match.groupdict().get("x") is not None
    owner = match.end("x") - 1 if named else match.end("a") - 1
    number = number if named or any(look.color for look in looks) else 0
    found = []
    for place, token in enumerate(tokens):
        only_says = match.start() <= place < match.end() and match.string[place] in _SAID
        if place == owner and number:
            noun = token.noun or "unknown"  # that of a look too: "the lawn", "the black plastic"
            found.append(Token(token.text, scene=token.scene, noun=noun, presents=looks, change=number))
        elif match.start("b") <= place < match.end("b"):
            found.append(replace(token, change=number))
        elif not (match.start("a") <= place < match.end("a") or only_says):
            found.append(token)
    return found
