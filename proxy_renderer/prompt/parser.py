# SPDX-License-Identifier: Apache-2.0
"""Understands a prompt: which look words there are, and what each of them describes."""

from __future__ import annotations

import re

from ..schema import VibeError
from ..schema.limits import LONGEST_PROMPT
from .english import ONLY_ENGLISH, other_language
from .keyed import spoken, without_spared
from .lexicon import hours, kelvins
from .lexicon.user_words import default_vocabulary
from .lexicon.vocabulary import Vocabulary
from .meaning import complete
from .reader import PromptReader
from .types import Parsed, SceneWords

_TAG = re.compile(r"</?[a-zA-Z][^<>]{0,200}>|\x1b\[[0-9;]*[A-Za-z]|[\x00-\x08\x0e-\x1f\x7f]")
_THINGS_STAY = "things are not added, moved or removed, only their look changes."


def parse(prompt: str, scene: SceneWords, vocabulary: Vocabulary | None = None) -> Parsed:
    """Finds the look words of a prompt and binds them to subject, surroundings, lights or the film.

    Raises:
        VibeError: The prompt is empty, too long, or holds no look word at all.
    """
    text = " ".join(_TAG.sub(" ", prompt).split())
    if not text:
        raise VibeError(
            "The prompt is empty.", "Describe a look, for example: 'glossy teal, white studio background'."
        )
    if len(text) > LONGEST_PROMPT:
        raise VibeError(f"The prompt has {len(text)} characters.", f"Say it in {LONGEST_PROMPT} or less.")
    foreign = other_language(text)
    if foreign == "all":
        raise VibeError(f"The prompt '{text[:60]}' is not in English.", ONLY_ENGLISH)
    vocabulary = vocabulary or default_vocabulary()
    reader = PromptReader(vocabulary, scene)
    told = kelvins.told(hours.told(text, vocabulary))
    said, spared = without_spared(spoken(told, vocabulary, reader.lexer.names))
    parsed = reader.read(said)
    if not parsed.attributes and reader.named:  # "castle": if it is nothing else, it is a mood
        reader = PromptReader(vocabulary, scene, things=False)
        parsed = reader.read(said)
    parsed.prompt = text
    parsed.conflicts += [f"'{words}': what no word names stays as it is." for words in spared]
    if reader.beyond:
        said = ", ".join(f"'{text}'" for text in dict.fromkeys(reader.beyond))
        parsed.conflicts.append(f"{said}: no value of a material, light, world, fog or film gives that.")
    if reader.undone:
        said = ", ".join(f"'{text}'" for text in dict.fromkeys(reader.undone))
        parsed.conflicts.append(f"{said}: {_THINGS_STAY}")
    if foreign:
        parsed.conflicts.append(f"Some of the prompt does not look like English. {ONLY_ENGLISH}")
    if not parsed.attributes or (foreign and all(a.guess or a.cause for a in parsed.attributes)):
        raise VibeError(
            f"Nothing in the prompt '{text[:60]}' names a look{' in English' if foreign else ''}"
            + (f": {_THINGS_STAY}" if reader.undone else "."),
            "Name colors (teal), materials (glossy, gold), light (warm soft light), fog, grading (noir, vignette) "
            "or a mood (cosy, ominous).",
        )
    things = [(t.name, t.region, t.owners) for t in reader.binding.things]
    complete(parsed, reader.vocabulary, reader.act.subject, things)
    return parsed
