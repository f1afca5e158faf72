# SPDX-License-Identifier: Apache-2.0
"""From a model's words to one JSON object. Nothing in them is ever run or opened."""

from __future__ import annotations

import json
import unicodedata
from collections.abc import Collection
from typing import Any

from .transport import ModelError

_SECRET = 12  # characters; real keys have 20 or more
_TRIES = 200  # braces that are tried in a text around the object


def find_object(text: str, names: Collection[str]) -> dict[str, Any]:
    """The JSON object in a text: alone, fenced, or among other words.

    Args:
        text: The model's words; what it thought before (`<think>`) is left out.
        names: The object has at least one of these.

    Raises:
        ModelError: There is none, say because it was cut off.
    """
    text = text.rpartition("</think>")[2]
    decoder = json.JSONDecoder(parse_constant=_no_number)
    place = -1
    for _ in range(_TRIES):
        place = text.find("{", place + 1)
        if place < 0:
            break
        try:
            candidate, _ = decoder.raw_decode(text, place)
        except (ValueError, RecursionError):
            continue
        if isinstance(candidate, dict) and any(name in candidate for name in names):
            return candidate
    if not text.strip():
        raise ModelError("The model's answer is empty.", "Use another model.")
    raise ModelError(
        "The model's answer is not the JSON object that was asked for.",
        "Use a larger model, or one that follows a JSON schema.",
    )


def clean(text: Any, longest: int) -> str:
    r"""A model's text for people: one line, without control and direction characters.

    Args:
        text: Any JSON value; one that is no text gives "".

    Example:
        >>> clean("warm\n  light", 40)
        'warm light'
    """
    if not isinstance(text, str):
        return ""
    shown = "".join(" " if c.isspace() else c for c in text[: 20 * longest])
    shown = "".join(c for c in shown if unicodedata.category(c)[0] != "C")
    return " ".join(shown.split())[:longest].strip()


def scrub(value: Any, secret: str) -> Any:
    """A JSON value without a secret in any of its strings: a hostile server could send the key back.

    Args:
        value: Texts, lists and objects are searched, keys of objects too.
        secret: The key. A short one, such as the "ollama" that local servers are given, is a word and stays.

    Example:
        >>> scrub({"error": "wrong key sk-0123456789abcdef"}, "sk-0123456789abcdef")
        {'error': 'wrong key ***'}
    """
    if len(secret) < _SECRET:
        return value
    if isinstance(value, str):
        return value.replace(secret, "***")
    if isinstance(value, list):
        return [scrub(v, secret) for v in value]
    if isinstance(value, dict):
        return {scrub(k, secret): scrub(v, secret) for k, v in value.items()}
    return value


def _no_number(name: str) -> float:
    raise ValueError(f"{name} is not JSON")
