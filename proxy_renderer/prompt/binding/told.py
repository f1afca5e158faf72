# SPDX-License-Identifier: Apache-2.0
"""What the artist says that a word describes, against what the reader takes it for: `--target copper=Cup`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...schema import VibeError
from ..lexicon.entries import normalize
from ..lexicon.vocabulary import Vocabulary
from ..types import SceneWords
from .becoming import becoming
from .bound import Thing
from .pairs import TargetPair
from .targets import ROLES, Target

GENERAL = {
    "not used": "none", "lights": "light", "light": "light", "key light": "key", "fill light": "fill",
    "rim light": "rim", "world": "sky", "sky": "sky", "air": "air", "image": "picture", "subject": "subject",
    "surroundings": "surroundings",
}  # fmt: skip
"""What a word may be told to describe beside the scene's own things -> kind of target."""


class ToldTargets:
    """The targets that an artist has chosen for words.

    Args:
        told: Word of the prompt -> a name in the scene, or one of "lights", "key light", "world", "image", "not used" and so on.
        scene: Its names.
        vocabulary: What words mean.

    Raises:
        VibeError: The scene has nothing of such a name.
    """

    def __init__(self, told: Mapping[str, str], scene: SceneWords, vocabulary: Vocabulary) -> None:
        self._vocabulary = vocabulary
        self._names = {normalize(word): name for word, name in told.items()}
        self._targets = {word: _target(word, name, scene) for word, name in self._names.items()}
        self._used: set[str] = set()

    def of(self, pair: TargetPair) -> TargetPair | None:
        """A look word with the target that it was told; None where it was told none.

        Args:
            pair: What the reader takes it for.

        Raises:
            VibeError: The word can say nothing of that.
        """
        word = next((w for w in (pair.look.text, pair.look.token.text) if w in self._targets), "")
        if not word:
            return None
        self._used.add(word)
        target = self._targets[word]
        means = becoming(pair.look.token, target.kind, self._vocabulary)
        if means is None:
            raise VibeError(
                f"'{word}' can say nothing of {self._names[word]!r}.", "Choose another target, or 'not used'."
            )
        return TargetPair(pair.look, target, means, (), told=True)

    def thing(self, pair: TargetPair, thing: Thing) -> Thing:
        """A thing by the name that the artist gave it.

        Args:
            pair: Told.
            thing: As the reader calls it.
        """
        word = pair.look.text if pair.look.text in self._names else pair.look.token.text
        return replace(thing, thing=self._names[word]) if pair.target.names else thing

    def unused(self) -> list[str]:
        """Words that were told a target and are no look words of the prompt."""
        return [word for word in self._names if word not in self._used]


def _target(word: str, name: str, scene: SceneWords) -> Target:
    said = name.casefold()
    kind = GENERAL.get(said, "")
    if kind in ROLES:
        return Target(kind, frozenset(n for n, light in scene.lights.items() if light.role == kind))
    if kind:
        return Target(kind)
    for names, find in (
        (scene.object_materials, lambda own: Target("things", frozenset(scene.object_materials[own]))),
        (scene.materials, lambda own: Target("things", frozenset({own}))),
        (scene.lights, lambda own: Target("lights", frozenset({own}))),
    ):
        own = next((own for own in names if own.casefold() == said), None)
        if own is not None:
            return find(own)
    raise VibeError(
        f"'{name}', which '{word}' is to describe, is no object, material or light of the scene.",
        f"Use a name in the scene, or one of: {', '.join(GENERAL)}.",
    )
