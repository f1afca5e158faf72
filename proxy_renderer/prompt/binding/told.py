# SPDX-License-Identifier: Apache-2.0
"""What the artist says that a word describes, against what the reader takes it for: `--target copper=Cup`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from ...schema import VibeError
from ...schema.targets import GENERAL, NUMBER, joined, parted
from ..lexicon.entries import normalize
from ..lexicon.vocabulary import Vocabulary
from ..types import GLOW, SceneDescription
from .becoming import becoming
from .bound import Thing
from .naming import glow_name
from .pairs import TargetPair
from .targets import ROLES, Target


def key_numbers(texts: Sequence[str]) -> list[str]:
    """What follows each look word in its key: "#2" for the second of equal ones, nothing where the prompt says it once.

    Args:
        texts: Of all look words of a prompt, in English.
    """
    each = ((text, texts[: number + 1].count(text)) for number, text in enumerate(texts))
    return [f"{NUMBER}{count}" if texts.count(text) > 1 else "" for text, count in each]


def plain_key(key: str) -> str:
    """The word of a key without its number: "red" of "red#2"."""
    word, mark, number = key.rpartition(NUMBER)
    return word if mark and number.isdigit() else key


@dataclass(frozen=True)
class _Choice:
    """A word with the target that an artist has chosen.

    Attributes:
        word: As the artist wrote it.
        known: The words in English by which the reader may know it, normalized.
        number: Which of several equal words of the prompt; 0 for all of them.
        name: Of the target.
        target: What that is in the scene.
    """

    word: str
    known: frozenset[str]
    number: int
    name: str
    target: Target


class ToldTargets:
    """The targets that an artist has chosen for words.

    Args:
        told: Word of the prompt -> a name in the scene, several with " + ", or one of `schema.targets.GENERAL`.
        english: Word of the prompt -> the same in English, where the prompt is in another language.
        keyed: Number of a look word -> the name in the scene that the prompt itself sets before it: "Cup: copper".

    Raises:
        VibeError: The scene has nothing of such a name.
    """

    def __init__(
        self,
        told: Mapping[str, str],
        scene: SceneDescription,
        vocabulary: Vocabulary,
        english: Mapping[str, str] | None = None,
        keyed: Mapping[int, str] | None = None,
    ) -> None:
        self._vocabulary, self._scene, self._keyed = vocabulary, scene, keyed or {}
        self._choices = [_choice(key, name, scene, english or {}) for key, name in told.items()]
        self._used: set[str] = set()

    def bound(self, chosen: Iterable[TargetPair]) -> list[TargetPair]:
        """Look words with the targets that they were told, or else as the reader takes them.

        Args:
            chosen: The reader's pair of each look word.

        Raises:
            VibeError: A word can say nothing of its target.
        """
        numbers: Counter[str] = Counter()
        found = []
        for number, pair in enumerate(chosen):
            numbers[pair.look.text] += 1
            choice = self._of(pair, numbers[pair.look.text])
            found.append(self._told(pair, choice) if choice else self._after_its_key(number, pair))
        return found

    def _after_its_key(self, number: int, pair: TargetPair) -> TargetPair:
        """A look word with the target that the prompt sets before it, if it can say something of that."""
        name = self._keyed.get(number, "")
        target = _target(pair.look.text, name, self._scene) if name else pair.target
        means = becoming(pair.look.token, target.kind, self._vocabulary) if name else None
        return TargetPair(pair.look, target, means, (), told=name) if means else pair

    def _of(self, pair: TargetPair, number: int) -> _Choice | None:
        names = {pair.look.text, pair.look.token.text}
        fitting = (c for c in self._choices if c.number in (0, number) and not names.isdisjoint(c.known))
        return next(fitting, None)

    def _told(self, pair: TargetPair, choice: _Choice) -> TargetPair:
        self._used.add(choice.word)
        means = becoming(pair.look.token, choice.target.kind, self._vocabulary)
        if means is None:
            raise VibeError(
                f"'{choice.word}' can say nothing of {choice.name!r}.",
                "Choose another target, or 'not used'.",
            )
        return TargetPair(pair.look, choice.target, means, (), told=choice.name)

    def unused(self) -> list[str]:
        """Words that were told a target and are no look words of the prompt."""
        return [choice.word for choice in self._choices if choice.word not in self._used]


def told_thing(pair: TargetPair, thing: Thing) -> Thing:
    """A thing by the name that the artist gave it."""
    return replace(thing, thing=pair.told) if pair.target.names else thing


def _choice(key: str, name: str, scene: SceneDescription, english: Mapping[str, str]) -> _Choice:
    word = plain_key(key)
    translated = normalize(english.get(word, ""))
    known = {normalize(word), translated, *translated.split()} - {""}
    return _Choice(word, frozenset(known), int(key[len(word) + 1 :] or 0), name, _target(word, name, scene))


def _target(word: str, name: str, scene: SceneDescription) -> Target:
    """What a name means in a scene, or several names that " + " joins."""
    found = _named(name, scene)
    several = [_named(part, scene) for part in parted(name)]
    if found is None and all(several):
        targets = [target for target in several if target]
        if len({target.kind for target in targets}) == 1 and all(target.names for target in targets):
            found = replace(targets[0], names=frozenset().union(*(target.names for target in targets)))
    if found is None:
        raise VibeError(
            f"'{name}', which '{word}' is to describe, is no object, material or light of the scene.",
            f"Use a name in the scene, several with{joined(['', ''])}between them, or one of: {', '.join(GENERAL)}.",
        )
    return found


def _named(name: str, scene: SceneDescription) -> Target | None:
    """What a name means: something of the scene, or what every scene has; upper and lower case count only between these."""
    own = {each: Target("lights", frozenset({each})) for each in scene.lights}
    own |= {glow_name(each): Target("lights", frozenset({GLOW + each})) for each in scene.glows}
    own |= {each: Target("things", frozenset({each})) for each in scene.materials}
    own |= {each: Target("things", frozenset(worn)) for each, worn in scene.object_materials.items()}
    said = name.casefold()
    kind = "" if name in own else GENERAL.get(said, "")
    if kind in ROLES:
        return Target(kind, frozenset(n for n, light in scene.lights.items() if light.role == kind))
    if kind:
        return Target(kind)
    return own.get(name) or next((target for each, target in own.items() if each.casefold() == said), None)
