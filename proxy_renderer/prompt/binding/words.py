# SPDX-License-Identifier: Apache-2.0
"""The words of a prompt as they are understood: each with its place, sense, target, and what else it may describe."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

from ...schema.targets import GENERAL, NOT_USED, OFFERED, joined
from ..lexicon.entries import normalize
from ..lexicon.vocabulary import Vocabulary
from ..tokens import Token
from ..types import Candidate, Parsed, PromptWord, SceneDescription
from .becoming import becoming
from .naming import described_name, target_name
from .reader import PromptReader
from .told import key_numbers

_LEAST = 0.02  # probability of a candidate
_MOST = 16  # objects, and lights, that a word is offered besides


def prompt_words(reader: PromptReader, parsed: Parsed, said: Callable[[str], str]) -> tuple[PromptWord, ...]:
    """The look words of a prompt and the words that are left out, in the order of the text.

    Args:
        said: The prompt's own words for English ones.
    """
    looks = (_look_word(reader, parsed, number, said) for number in range(len(reader.chosen)))
    numbers = key_numbers([pair.look.text for pair in reader.chosen])
    both = zip(looks, numbers, strict=True)
    words = [replace(word, key=normalize(word.key) + number) for word, number in both if word]
    known = {word.text for word in words}
    words += [PromptWord(text, text) for text in dict.fromkeys(parsed.ignored) if text not in known]
    return _placed(words, parsed.prompt)


def _look_word(
    reader: PromptReader, parsed: Parsed, number: int, said: Callable[[str], str]
) -> PromptWord | None:
    """A look word; None where it is part of another word, or a later word takes it back."""
    pair = reader.chosen[number]
    attributes = [a for a in parsed.attributes if a.look == number and not a.cause]
    if not attributes and number not in reader.unused:
        return None
    names = dict.fromkeys(pair.told or described_name(a, reader.scene) for a in attributes)
    target = joined(names) if names else NOT_USED
    candidates = _candidates(reader, number, next(iter(names), NOT_USED))
    offered = _offered(pair.look.token, reader.scene, reader.vocabulary)
    first = attributes[0] if attributes else None
    return PromptWord(
        text=first.word if first else said(pair.look.text),
        key=said(pair.look.text),
        entry=first.entry if first else "",
        strength=pair.look.strength,
        negated=pair.look.negated,
        target=target,
        thing=first.thing if first and first.thing not in first.word else "",
        confidence=candidates[0].probability,
        candidates=candidates,
        others=tuple(name for name in offered if name not in {c.name for c in candidates}),
        guess=pair.look.token.guess,
    )


def _candidates(reader: PromptReader, number: int, target: str) -> tuple[Candidate, ...]:
    """What a look word may describe: its target, then the likeliest."""
    chosen = reader.chosen[number]
    found = {target: 0.0}
    for pair, probability in reader.probabilities[number]:
        is_chosen = pair.target == chosen.target and target != NOT_USED
        if name := target if is_chosen else target_name(pair.target, reader.scene):
            found[name] = found.get(name, 0.0) + probability
    if chosen.told or id(chosen) in reader.absent:
        found[target] = 1.0
    likely = sorted(found, key=lambda name: (name != target, -found[name]))
    likely = [
        n for n in likely if n == target or (found[n] >= _LEAST and n != NOT_USED)
    ]  # it is offered last
    return tuple(Candidate(name, round(found[name], 3)) for name in likely)


def _offered(token: Token, scene: SceneDescription, vocabulary: Vocabulary) -> Iterator[str]:
    """Names in a scene that a word can describe, the largest in the image first, and general ones."""

    def fits(kind: str) -> bool:
        return becoming(token, kind, vocabulary) is not None

    if fits("things"):
        yield from scene.made(_largest, vocabulary)
    if fits("lights"):
        yield from [*scene.lights][:_MOST]
    yield from (name for name in OFFERED if fits(GENERAL[name]))


def _largest(scene: SceneDescription, _: Vocabulary) -> list[str]:
    """The objects that cover most of the image."""

    def share(name: str) -> float:
        looks = (scene.looks[m] for m in scene.object_materials[name] if m in scene.looks)
        return sum(look.worn.get(name, 0.0) for look in looks)

    return sorted(scene.object_materials, key=share, reverse=True)[:_MOST]


def _placed(words: Iterable[PromptWord], prompt: str) -> tuple[PromptWord, ...]:
    """Words with their places in a prompt, in its order; those that it says in other letters come last."""
    found, end = [], 0
    for word in words:
        pattern = re.compile(r"[\W_]+".join(map(re.escape, re.findall(r"[^\W_]+", word.text))), re.IGNORECASE)
        match = (pattern.search(prompt, end) or pattern.search(prompt)) if pattern.pattern else None
        end = match.end() if match and word.candidates else end
        found.append(replace(word, place=match.span() if match else None))
    return tuple(sorted(found, key=lambda word: word.place or (len(prompt), len(prompt))))
