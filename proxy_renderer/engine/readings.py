# SPDX-License-Identifier: Apache-2.0
"""How the words of a prompt are understood, one by one, while they are typed."""

from __future__ import annotations

from pathlib import Path

from ..optimize.context import scene_words
from ..prompt.lexicon.nearest import Nearest
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.types import PromptWord, SceneWords
from ..prompt.understood import Understood
from ..scene import load_scene
from ..schema.messages import AskReadings, Readings, WordReading
from ..schema.targets import parted, spoken

_OTHERS = 2  # known words that are offered in place of one that is not used


class WordReader:
    """Reads prompts against exported scenes, the last of which it remembers."""

    def __init__(self) -> None:
        self._job: tuple[str, int] = ("", 0)
        self._scene = SceneWords()

    def read(self, request: AskReadings) -> Readings:
        """The words of a prompt as a vibe of the exported scene understands them.

        Args:
            request: The words, and the scene.

        Raises:
            VibeError: The scene cannot be read.
        """
        if not request.prompt.strip():
            return Readings(request.prompt)
        scene = self._described(request.job)
        understood = Understood(request.prompt, scene, request.target)
        note = str(understood.unknown or "")
        if not understood.words:  # a target that cannot be is taken back by a click on its word
            understood = Understood(request.prompt, scene)
        return Readings(request.prompt, [*map(_reading, understood.words)], note)

    def _described(self, job: str) -> SceneWords:
        """The names in an exported scene; none without one."""
        if not job:
            return SceneWords()
        known = job, (Path(job) / "scene.json").stat().st_mtime_ns
        if known != self._job:
            self._scene, self._job = scene_words(load_scene(job)), known
        return self._scene


def _reading(word: PromptWord) -> WordReading:
    """A word with what it describes; one that is not used, with known words in its place."""
    names = [candidate.name for candidate in word.candidates]
    if not word.is_used:
        others = default_vocabulary().made(Nearest).choices(word.text, _OTHERS)
        return WordReading(word.text, "left out", word.target, others, word.key, names, [*word.others])
    describes = f"describes {_listed(word.target)}"
    if word.guess:
        state, meaning = "guessed", f"taken for “{word.guess}”, {describes}"
    else:
        state, meaning = "understood", describes
    return WordReading(word.text, state, meaning, [], word.key, names, [*word.others])


def _listed(target: str) -> str:
    """A target as a sentence has it: "Cup and Table"."""
    return " and ".join(map(spoken, parted(target)))
