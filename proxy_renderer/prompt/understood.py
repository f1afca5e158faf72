# SPDX-License-Identifier: Apache-2.0
"""A prompt, read once against one description of a scene, for everyone who needs to know what it says."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import InitVar, dataclass, field

from ..schema import VibeError
from ..schema.options import checks
from .lexicon.user_words import default_vocabulary
from .parser import read
from .types import Parsed, PromptWord, SceneDescription


@dataclass(frozen=True)
class Understood:
    """What a prompt says of a scene.

    Attributes:
        prompt: What the artist typed.
        scene: The names in the scene.
        told: "copper=Cup": what the artist says that words describe.
        words: The look words of the prompt and the words that are left out, in its order.
        unknown: Why nothing in the prompt is understood; None where something is.
    """

    prompt: str
    scene: SceneDescription
    told: InitVar[Iterable[str]] = ()
    words: tuple[PromptWord, ...] = field(default=(), init=False)
    unknown: VibeError | None = field(default=None, init=False)
    _parsed: Parsed = field(default_factory=lambda: Parsed(""), init=False, repr=False)

    def __post_init__(self, told: Iterable[str]) -> None:
        """Reads the prompt."""
        try:
            parsed = read(self.prompt, self.scene, default_vocabulary(), told=checks.targets(told))
        except VibeError as error:
            object.__setattr__(self, "unknown", error)
        else:
            object.__setattr__(self, "_parsed", parsed)
            object.__setattr__(self, "words", parsed.words)
            object.__setattr__(self, "unknown", parsed.unknown)

    @property
    def parsed(self) -> Parsed:
        """What is understood; the same for everyone, who leave it as it is.

        Raises:
            VibeError: Nothing is.
        """
        if self.unknown:
            raise self.unknown
        return self._parsed
