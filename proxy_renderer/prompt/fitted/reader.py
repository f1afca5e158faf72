# SPDX-License-Identifier: Apache-2.0
"""Binds the look words of a prompt by fitted weights."""

from __future__ import annotations

from collections.abc import Mapping

from ..binding import Binder
from ..lexicon.vocabulary import Vocabulary
from ..meaning import NamedThing
from ..reader import PromptReader
from ..types import Parsed, SceneWords
from .assignment import assigned
from .bound import Things
from .model import shipped_weights
from .pairs import PromptPairs, TargetPair, reading
from .targets import TINGE


class FittedReader:
    """Scores every look word with everything that it may describe, and takes what is likeliest together.

    Args:
        vocabulary: What is known.
        scene: The names in the scene.
        weights: By feature; None for those that are shipped.

    Attributes:
        beyond: Words of a picture that no value could give.
        undone: Wishes that values cannot fulfill.
        found: The pairs of the prompt.
        chosen: The pair of each of its look words.
    """

    def __init__(
        self, vocabulary: Vocabulary, scene: SceneWords, weights: Mapping[str, float] | None = None
    ) -> None:
        self.vocabulary, self.scene = vocabulary, scene
        self.weights = shipped_weights() if weights is None else weights
        self.subject = scene.subject
        self.mentioned: list[NamedThing] = []
        self.beyond: list[str] = []
        self.undone: list[str] = []

    def read(self, text: str) -> Parsed:
        """Binds every look word; the result lacks what `meaning.complete` adds.

        Args:
            text: The prompt, prepared.
        """
        self.found: PromptPairs = reading(text, self.scene, self.vocabulary)
        self.chosen: list[TargetPair] = assigned(self.found, self.weights)
        binder = Binder(self.vocabulary, "", self._means)
        things = Things(self.found, self.chosen, self.scene)
        parsed = Parsed(text)
        for pair in self.chosen:
            word = pair.look.word
            if pair.target.kind == TINGE:
                continue
            if pair.target.kind == "none":
                binder.ignored.append(word.text)
                continue
            entry = pair.becoming.entry or word.token.name or word.token.text
            binder.add(word, entry, things.of(pair))
            if word.token.guess:
                parsed.guesses[word.token.text] = word.token.guess
            if pair.look.guessed and word.token.near:
                parsed.confidence[word.token.text] = word.token.near.confidence
        self.mentioned = things.mentioned
        self.beyond = self.found.passage.beyond
        self.undone = [" ".join(words) for words in self.found.passage.wishes]
        parsed.attributes = binder.attributes
        left = [word for words in self.found.passage.wishes for word in words]
        unknown = [m.text for m in self.found.mentions if m.noun == "unknown" and not m.named]
        parsed.ignored = [*binder.ignored, *left, *self.beyond, *unknown]
        return parsed

    def _means(self, text: str, cause: str) -> Parsed:
        return PromptReader(self.vocabulary, SceneWords(), cause).read(text)
