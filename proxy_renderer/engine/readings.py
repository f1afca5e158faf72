# SPDX-License-Identifier: Apache-2.0
"""How the words of a prompt are understood, one by one, while they are typed."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from ..prompt.lexicon.nearest import Nearest
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.types import Attribute, LightWords, Parsed, SceneWords
from ..prompt.understood import Understood
from ..schema import VibeError
from ..schema.limits import LONGEST_PROMPT
from ..schema.messages import AskReadings, Readings, WordReading

_OTHERS = 2  # known words that are offered in place of one that is not used


def readings(request: AskReadings) -> Readings:
    """Reads the words of a prompt in a scene of which only names are known.

    Args:
        request: The words, and the names.
    """
    if not request.prompt.strip():
        return Readings(request.prompt)
    note = ""
    try:
        parsed = Understood(request.prompt, _names(request), request.target).parsed
    except VibeError as error:
        note, parsed = str(error), Parsed(request.prompt, ignored=_offered(request.prompt))
    told = [*_understood(parsed), *map(_left_out, dict.fromkeys(parsed.ignored))]
    said = request.prompt.casefold()
    return Readings(request.prompt, sorted(told, key=lambda word: _place(said, word.text)), note)


def _offered(prompt: str) -> list[str]:
    """The unknown words of a prompt in which no look is understood, for which known ones are offered."""
    words = re.findall(r"[^\W\d_]+", prompt[:LONGEST_PROMPT].lower())
    return [word for word in words if default_vocabulary().made(Nearest).may_be_a_look(word)]


def _names(request: AskReadings) -> SceneWords:
    """The scene as readers take it; what is the subject is not known before the scene is read."""
    return SceneWords(
        objects=dict.fromkeys(request.objects, "subject"),
        materials=dict.fromkeys((m for names in request.objects.values() for m in names), "subject"),
        object_materials={name: tuple(materials) for name, materials in request.objects.items()},
        lights={name: LightWords(kind) for name, kind in request.lights.items()},
    )


def _understood(parsed: Parsed) -> Iterator[WordReading]:
    """The look words that the prompt itself says, each with all that it describes."""
    of_word: dict[str, list[Attribute]] = {}
    for attribute in parsed.attributes:
        if not attribute.cause:
            of_word.setdefault(attribute.word, []).append(attribute)
    for word, attributes in of_word.items():
        things = ", ".join(dict.fromkeys(_described(a) for a in attributes))
        if mistyped := _guessed(word, parsed.guesses):
            known = parsed.guesses[mistyped]
            yield WordReading(word, "guessed", f"taken for “{known}”, describes {things}")
        else:
            yield WordReading(word, "understood", f"describes {things}")


def _described(attribute: Attribute) -> str:
    """What a look word describes, for people."""
    region = "the picture" if attribute.region == "whole" else f"the {attribute.region}"
    if attribute.thing and attribute.thing not in attribute.word:  # a noun of the prompt's own
        return attribute.thing
    return ", ".join(attribute.owners) or region


def _guessed(word: str, guesses: Mapping[str, str]) -> str:
    """The misspelled word in a look word with its intensity: "glosy" of "very glosy"; "" if all is known."""
    return next((unknown for unknown in guesses if word.endswith(unknown)), "")


def _left_out(word: str) -> WordReading:
    return WordReading(
        word, "left out", "not used", default_vocabulary().made(Nearest).choices(word, _OTHERS)
    )


def _place(said: str, word: str) -> int:
    """Where a prompt says a word; behind everything else where it says it in other letters."""
    place = said.find(word.casefold())
    return len(said) if place < 0 else place
