# SPDX-License-Identifier: Apache-2.0
"""Prompts written as keys and values, as programs and form fillers write them, said as a sentence would."""

from __future__ import annotations

import re

from .vocabulary import Vocabulary

_PAIR = re.compile(
    r"""["']?(\w[\w -]{0,30}?)["']?\s*[:=]\s*["']?([^:=,;.{}"'\n]{1,40}?)["']?(?=\s*(?:[,;.}]|$))"""
)
_OFF = ("none", "no", "off", "false", "0", "zero", "null", "disabled", "without")
_MOST = 4  # words of a value; more are a sentence of their own


def spoken(text: str, vocabulary: Vocabulary) -> str:
    """ "fog: none, background: white" -> "no fog, white background"; other colons stay as they are."""

    def said(pair: re.Match[str]) -> str:
        key, value = pair[1].strip().lower(), pair[2].strip()
        if value.lower() in _OFF:
            return f"no {key}"
        noun = key in vocabulary.nouns and key not in vocabulary.lists["stop"]
        return f"{value} {key}" if noun and len(value.split()) <= _MOST else pair[0]

    return _PAIR.sub(said, text)
