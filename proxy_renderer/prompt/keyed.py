# SPDX-License-Identifier: Apache-2.0
"""Prompts written as keys and values or as lists, as programs and form fillers write them, said as a sentence would."""

from __future__ import annotations

import re
from collections.abc import Container

from .lexicon.vocabulary import Vocabulary

_PAIR = re.compile(
    r"""["']?(\w[\w -]{0,30}?)["']?\s*[:=]\s*["']?([^:=,;.{}"'\n]{1,40}?)["']?(?=\s*(?:[,;.}]|$))"""
)
_SPARED = re.compile(
    r"\b(?:leave|keep|do not touch|don't touch|don't change|do not change)\b[^,.;:]*?"
    r"\b(?:alone|unchanged|untouched|as is|as (?:it|they) (?:is|are|was|were)|the same)\b",
    re.IGNORECASE,
)
_COLOR = r"([a-z]+(?: (?!and\b)[a-z]+)?)"
_LIGHTS = re.compile(
    r"\b(?:\w+ )?(?:two|both|colou?red|contrasting|different) (?:colou?red )?(?:lights|lamps|gels)\s*[,:(]\s*(?:one )?"
    rf"{_COLOR}\s*,?\s*(?:and (?:one |the other )?|(?:the other|one) ){_COLOR}(?=\s*(?:[,;.)]|$))",
    re.IGNORECASE,
)
_MOST = 4  # words of a value; more are a sentence of their own


def spoken(text: str, vocabulary: Vocabulary, names: Container[str] = ()) -> str:
    """ "fog: none, background: white" -> "no fog, white background"; lights that are listed get their colors likewise.

    Args:
        text: The prompt.
        vocabulary: Has the nouns that may be keys.
        names: Of things in the scene, which may be too.
    """

    def said(pair: re.Match[str]) -> str:
        key, value = pair[1].strip().lower(), pair[2].strip()
        if value.lower() in vocabulary.off:
            return f"no {key}"
        if key in names:
            return f"the {key} is {value}"
        noun = key in vocabulary.nouns and key not in vocabulary.lists["stop"]
        return f"{value} {key}" if noun and len(value.split()) <= _MOST else pair[0]

    def colored(lights: re.Match[str]) -> str:
        """ "Two lights, one red, one blue" -> "red and blue lights"."""
        both = all(name.lower() in vocabulary.colors for name in lights.groups())
        return f"{lights[1]} and {lights[2]} lights" if both else lights[0]

    return _LIGHTS.sub(colored, _PAIR.sub(said, text))


def without_spared(text: str) -> tuple[str, list[str]]:
    """A prompt without what it says should stay ("leave the cup alone"), and what that is."""
    spared = _SPARED.findall(text)
    return _SPARED.sub(",", text) if _SPARED.sub("", text).strip(" ,.;") else text, spared
