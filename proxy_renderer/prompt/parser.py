# SPDX-License-Identifier: Apache-2.0
"""Understands a prompt: which look words there are, and what each of them describes."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from ..schema import VibeError
from ..schema.limits import LONGEST_PROMPT
from .binding.model import FactWeights
from .binding.pairs import looks
from .binding.reader import PromptReader
from .binding.told import plain_key
from .binding.words import prompt_words
from .keyed import KeyedSpan, keyed_spans, spoken
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
from .types import Parsed, SceneDescription

_TAG = re.compile(r"</?[a-zA-Z][^<>]{0,200}>|\x1b\[[0-9;]*[A-Za-z]|[\x00-\x08\x0e-\x1f\x7f]")
_THINGS_STAY = "things are not added, moved or removed, only their look changes."


def prepared(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> str:
    """A prompt as readers take it."""
    return _prepared(gloss(text, scene, vocabulary).english, scene, vocabulary)[0]


def _prepared(
    text: str, scene: SceneDescription, vocabulary: Vocabulary
) -> tuple[str, list[KeyedSpan], list[Spared]]:
    """A prompt with hours, temperatures and lists as sentences say them; apart from it what it says after keys, and what stays."""
    told, own = kelvins.told(hours.told(text, vocabulary)), scene.made(_own_names, vocabulary)
    said, spared = without_spared(spoken(told, vocabulary, scene_names(scene), own), scene, vocabulary)
    return *keyed_spans(said, own), spared


def _own_names(scene: SceneDescription, _: Vocabulary) -> dict[str, str]:
    """The names of a scene's objects, materials and lights, by how they are in lower case."""
    return {name.lower(): name for name in (*scene.lights, *scene.materials, *scene.object_materials)}


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


@dataclass(frozen=True)
class _OpenedPrompt:
    """A prompt before its words are bound.

    Attributes:
        text: Without tags and needless white space.
        glossed: In English words.
        mixed: Whether some of it is in a language that is not understood.
        said: As readers take it.
        keyed: What it says of things that it sets before with a colon.
        spared: What is to stay as it is.
    """

    text: str
    glossed: Gloss
    mixed: bool
    said: str
    keyed: list[KeyedSpan]
    spared: list[Spared]

    @property
    def foreign_words(self) -> set[str]:
        """Words of another language that are left in it."""
        return {normalize(word) for word in self.glossed.unknown}


def _opened(prompt: str, scene: SceneDescription, vocabulary: Vocabulary) -> _OpenedPrompt:
    """A prompt in English words; VibeError where it is empty, too long, or in a language that is not understood."""
    text = _checked(prompt)
    glossed = gloss(text, scene, vocabulary)
    foreign = "" if glossed.language else other_language(text)
    if foreign == "all":
        raise VibeError(f"The prompt '{text[:60]}' is in a language that is not understood.", understood())
    return _OpenedPrompt(text, glossed, bool(foreign), *_prepared(glossed.english, scene, vocabulary))


def refuse_without_look(prompt: str) -> None:
    """Refuses a prompt that says nothing in any scene, before Blender is started.

    It only looks for look words. What they describe is read later, against the scene, see `understood.Understood`.

    Raises:
        VibeError: The prompt is empty, too long, in a language that is not understood, or has no look word.
    """
    scene, vocabulary = SceneDescription(), default_vocabulary()
    opened = _opened(prompt, scene, vocabulary)
    found = looks(opened.said, scene, vocabulary, opened.foreign_words)
    if not found.looks:
        raise _without_look(opened, [" ".join(words) for words in found.wishes])


def _without_look(opened: _OpenedPrompt, undone: Sequence[str], lacking: Iterable[str] = ()) -> VibeError:
    """The error for a prompt in which no look is understood."""
    language = opened.glossed.language or ("English" if opened.mixed else "")
    return VibeError(
        f"Nothing in the prompt '{opened.text[:60]}' names a look{f' in {language}' if language else ''}"
        + (f": {_THINGS_STAY}" if undone else ".")
        + "".join(f" {note}" for note in lacking),
        "Name colors (teal), materials (glossy, gold), light (warm soft light), fog, grading (noir, vignette) "
        "or a mood (cosy, ominous).",
    )


def parse(
    prompt: str,
    scene: SceneDescription,
    vocabulary: Vocabulary | None = None,
    weights: FactWeights | None = None,
    told: Mapping[str, str] | None = None,
) -> Parsed:
    """As `read`.

    Raises:
        VibeError: The prompt is empty, too long, or holds no look word at all.
    """
    parsed = read(prompt, scene, vocabulary, weights, told)
    if parsed.unknown:
        raise parsed.unknown
    return parsed


def read(
    prompt: str,
    scene: SceneDescription,
    vocabulary: Vocabulary | None = None,
    weights: FactWeights | None = None,
    told: Mapping[str, str] | None = None,
) -> Parsed:
    """Finds the look words of a prompt and binds them to subject, surroundings, lights or the film.

    Args:
        vocabulary: What words mean; the artist's own if None.
        weights: Of the reader; those that are shipped if None.
        told: Word -> what the artist says that it describes: a name in the scene, "lights", "not used" and so on.

    Returns:
        What is understood; `unknown` says why nothing is.

    Raises:
        VibeError: The prompt is empty, too long, or in a language that is not understood; a target cannot be.
    """
    vocabulary = vocabulary or default_vocabulary()
    opened = _opened(prompt, scene, vocabulary)
    glossed, retelling = opened.glossed, Retelling(opened.glossed)
    english = {word: retelling.english(word) for word in map(plain_key, told or ()) if glossed.language}
    found = PromptReader(vocabulary, scene, weights, told=told, english=english)
    parsed = found.read(opened.said, opened.foreign_words, opened.keyed)
    parsed.prompt = opened.text
    parsed.notes += map(str, opened.spared)
    parsed.protected = tuple(dict.fromkeys(key for each in opened.spared for key in each.kept))
    if found.beyond:
        parsed.notes.append(
            f"{_quoted(found.beyond)}: no value of a material, light, world, fog or film gives that."
        )
    if found.undone:
        parsed.notes.append(f"{_quoted(found.undone)}: {_THINGS_STAY}")
    if opened.mixed:
        parsed.notes.append(f"Some of the prompt is in a language that is not understood. {understood()}")
    if not parsed.attributes or (opened.mixed and all(a.guess or a.cause for a in parsed.attributes)):
        parsed.unknown = _without_look(opened, found.undone, found.lacking)
    complete(parsed, vocabulary, found.subject, found.mentioned, scene.sky)
    if glossed.language:
        retelling.retell(parsed)
        if unknown := glossed.unknown:
            lacks = f"The prompt was read as {glossed.language}, which lacks: {_quoted(unknown)}."
            parsed.notes.append(lacks)
    parsed.words = prompt_words(found, parsed, retelling.said)
    return parsed


def _quoted(words: Iterable[str]) -> str:
    return ", ".join(f"'{word}'" for word in dict.fromkeys(words))
