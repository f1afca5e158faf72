# SPDX-License-Identifier: Apache-2.0
"""Understands a prompt: which look words there are, and what each of them describes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from ..schema import VibeError
from ..schema.limits import LONGEST_PROMPT
from .binding.model import FactWeights
from .binding.reader import PromptReader
from .keyed import spoken
from .languages.gloss import Gloss, gloss
from .languages.retell import Retelling
from .languages.unread import other_language, understood
from .lexicon import hours, kelvins
from .lexicon.entries import normalize
from .lexicon.user_words import default_vocabulary
from .lexicon.vocabulary import Vocabulary
from .meaning import complete
from .names import scene_names
from .spared import Spared, without_spared
from .types import Parsed, SceneWords

_TAG = re.compile(r"</?[a-zA-Z][^<>]{0,200}>|\x1b\[[0-9;]*[A-Za-z]|[\x00-\x08\x0e-\x1f\x7f]")
_THINGS_STAY = "things are not added, moved or removed, only their look changes."


def prepared(text: str, scene: SceneWords, vocabulary: Vocabulary) -> str:
    """A prompt as readers take it.

    Args:
        text: The prompt.
        scene: The names in the scene.
        vocabulary: What words mean.
    """
    return _prepared(gloss(text, scene, vocabulary).english, scene, vocabulary)[0]


def _prepared(text: str, scene: SceneWords, vocabulary: Vocabulary) -> tuple[str, list[Spared]]:
    """A prompt with hours, temperatures and lists as sentences say them, and apart from it what is to stay as it is."""
    told = kelvins.told(hours.told(text, vocabulary))
    return without_spared(spoken(told, vocabulary, scene_names(scene)), scene, vocabulary)


def _checked(prompt: str) -> str:
    """A prompt without tags and needless white space; VibeError where it is empty or too long."""
    text = " ".join(_TAG.sub(" ", prompt).split())
    if not text:
        raise VibeError(
            "The prompt is empty.", "Describe a look, for example: 'glossy teal, white studio background'."
        )
    if len(text) > LONGEST_PROMPT:
        raise VibeError(f"The prompt has {len(text)} characters.", f"Say it in {LONGEST_PROMPT} or less.")
    return text


def parse(
    prompt: str,
    scene: SceneWords,
    vocabulary: Vocabulary | None = None,
    weights: FactWeights | None = None,
    told: Mapping[str, str] | None = None,
) -> Parsed:
    """Finds the look words of a prompt and binds them to subject, surroundings, lights or the film.

    Args:
        prompt: What the artist typed.
        scene: The names in the scene.
        vocabulary: What words mean; the artist's own if None.
        weights: Of the reader; those that are shipped if None.
        told: Word -> what the artist says that it describes: a name in the scene, "lights", "not used" and so on.

    Raises:
        VibeError: The prompt is empty, too long, or holds no look word at all.
    """
    text, vocabulary = _checked(prompt), vocabulary or default_vocabulary()
    glossed = gloss(text, scene, vocabulary)
    foreign = "" if glossed.language else other_language(text)
    if foreign == "all":
        raise VibeError(f"The prompt '{text[:60]}' is in a language that is not understood.", understood())
    said, spared = _prepared(glossed.english, scene, vocabulary)
    found = PromptReader(vocabulary, scene, weights, told=told)
    parsed = found.read(said, {normalize(word) for word in glossed.unknown})
    parsed.prompt = text
    parsed.notes += map(str, spared)
    parsed.protected = tuple(dict.fromkeys(key for each in spared for key in each.kept))
    if found.beyond:
        parsed.notes.append(
            f"{_quoted(found.beyond)}: no value of a material, light, world, fog or film gives that."
        )
    if found.undone:
        parsed.notes.append(f"{_quoted(found.undone)}: {_THINGS_STAY}")
    if foreign:
        parsed.notes.append(f"Some of the prompt is in a language that is not understood. {understood()}")
    if not parsed.attributes or (foreign and all(a.guess or a.cause for a in parsed.attributes)):
        raise VibeError(
            f"Nothing in the prompt '{text[:60]}' names a look{_in(glossed, foreign)}"
            + (f": {_THINGS_STAY}" if found.undone else ".")
            + "".join(f" {note}" for note in found.lacking),
            "Name colors (teal), materials (glossy, gold), light (warm soft light), fog, grading (noir, vignette) "
            "or a mood (cosy, ominous).",
        )
    complete(parsed, vocabulary, found.subject, found.mentioned, scene.sky)
    if glossed.language:
        Retelling(glossed).retell(parsed)
        if unknown := glossed.unknown:
            lacks = f"The prompt was read as {glossed.language}, which lacks: {_quoted(unknown)}."
            parsed.notes.append(lacks)
    return parsed


def _quoted(words: Iterable[str]) -> str:
    return ", ".join(f"'{word}'" for word in dict.fromkeys(words))


def _in(glossed: Gloss, foreign: str) -> str:
    """The language in which no look is named."""
    return f" in {glossed.language}" if glossed.language else " in English" if foreign else ""
