# SPDX-License-Identifier: Apache-2.0
"""Prompts written as keys and values or as lists, as programs and form fillers write them, said as a sentence would."""

from __future__ import annotations

import re
from collections.abc import Container, Mapping
from dataclasses import dataclass

from .lexicon.spelling import any_of
from .lexicon.vocabulary import Vocabulary

_PAIR = re.compile(
    r"""["']?(\w(?:[\w -]|\.(?=\w)){0,60}?)["']?\s*[:=]\s*["']?([^:=,;.{}"'\n]{1,40}?)["']?(?=\s*(?:[,;.}]|$))"""
)
_MARK = "\ue000"  # a character that nobody types
_IS = "the {} is "
_MOST = 4  # words of a value; more are a sentence of their own


@dataclass(frozen=True)
class KeyedSpan:
    """What a prompt says of something that it sets before with a colon: "Cup: copper".

    Attributes:
        name: Of the thing, as the scene has it.
        start: Where what is said begins in the text.
        end: Where it ends.
    """

    name: str
    start: int
    end: int


def keyed_spans(text: str, names: Mapping[str, str]) -> tuple[str, list[KeyedSpan]]:
    """A text of `spoken` without its marks, and where they were.

    Args:
        names: As for `spoken`.
    """
    said, spans = "", []
    for number, part in enumerate(text.split(_MARK)):
        key = max((key for key in names if said.endswith(_IS.format(key))), key=len, default="")
        if number % 2 and key:
            spans.append(KeyedSpan(names[key], len(said), len(said) + len(part)))
        said += part
    return said, spans


def spoken(text: str, vocabulary: Vocabulary, names: Container[str] = (), exact: Container[str] = ()) -> str:
    """ "fog: none, background: white" -> "no fog, white background"; lights that are listed get their colors likewise.

    Args:
        vocabulary: Has the nouns that may be keys.
        names: Of things in the scene, which may be too.
        exact: Whole names in the scene, in lower case; what is said of one is marked, see `keyed_spans`.
    """

    def said(pair: re.Match[str]) -> str:
        key, value = pair[1].strip().lower(), pair[2].strip()
        if value.lower() in vocabulary.words["off"]:
            return f"no {key}"
        if key in exact:
            return f"{_IS.format(key)}{_MARK}{value}{_MARK}"
        if key in names:
            return f"the {key} is {value}"
        short = len(value.split()) <= _MOST
        return f"{value} {key}" if short and key in vocabulary.nouns else pair[0]

    def colored(lights: re.Match[str]) -> str:
        """ "Two lights, one red, one blue" -> "red and blue lights"."""
        both = all(name.lower() in vocabulary.colors for name in lights.groups())
        return f"{lights[1]} and {lights[2]} lights" if both else lights[0]

    return vocabulary.made(_lights).sub(colored, _PAIR.sub(said, text))


def _lights(v: Vocabulary) -> re.Pattern[str]:
    """Two colors of lights that are listed."""
    color = rf"([a-z]+(?: (?!{_any(v, 'other')}\b)[a-z]+)?)"
    listed = rf"\s*[,:(]\s*(?:{_any(v, 'one')} )?{color}\s*,?\s*{_any(v, 'other')} {color}(?=\s*(?:[,;.)]|$))"
    return re.compile(rf"\b(?:\w+ )?{_any(v, 'several')} {_any(v, 'lamps')}{listed}", re.IGNORECASE)


def _any(v: Vocabulary, kind: str) -> str:
    """A pattern of any of the words of a kind, as Americans and others write them."""
    return any_of(v.words[kind]).replace("color", "colou?r")
