# SPDX-License-Identifier: Apache-2.0
"""A prompt, read once against one description of a scene, for everyone who needs to know what it says."""

from __future__ import annotations

from collections.abc import Iterable
from copy import deepcopy

from ..schema import VibeError
from ..schema.options import checks
from .lexicon.user_words import default_vocabulary
from .parser import parse
from .types import Parsed, SceneWords


class Understood:
    """What a prompt says of a scene.

    Args:
        prompt: What the artist typed.
        words: The names in the scene.
        told: "copper=Cup": what the artist says that words describe.

    Attributes:
        prompt: What the artist typed.
        words: The names in the scene.
        unknown: Why nothing in the prompt is understood; None where something is.
    """

    def __init__(self, prompt: str, words: SceneWords, told: Iterable[str] = ()) -> None:
        self.prompt, self.words = prompt, words
        self.unknown: VibeError | None = None
        self._parsed: Parsed | None = None
        try:
            self._parsed = parse(prompt, words, default_vocabulary(), told=checks.targets(told))
        except VibeError as error:
            self.unknown = error

    @property
    def parsed(self) -> Parsed:
        """What is understood, for its caller alone: planners take words out of it.

        Raises:
            VibeError: Nothing is.
        """
        if self._parsed is None:
            assert self.unknown
            raise self.unknown
        return deepcopy(self._parsed)
