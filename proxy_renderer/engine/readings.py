# SPDX-License-Identifier: Apache-2.0
"""How the words of a prompt are understood, one by one, while they are typed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..optimize.context import described
from ..prompt.lexicon.nearest import Nearest
from ..prompt.lexicon.user_words import default_vocabulary
from ..prompt.types import LightDescription, PromptWord, SceneDescription
from ..prompt.understood import Understood
from ..scene import load_scene
from ..schema.messages import AskReadings, Readings, WordReading
from ..schema.targets import GENERAL, listed

_OTHERS = 2  # known words that are offered in place of one that is not used


class WordReader:
    """Reads prompts against exported scenes, the last of which it remembers."""

    def __init__(self) -> None:
        self._job: tuple[str, int] = ("", 0)
        self._scene = SceneDescription()

    def read(self, request: AskReadings) -> Readings:
        """The words of a prompt as a vibe of the exported scene understands them.

        Raises:
            VibeError: The scene cannot be read.
        """
        scene = self._described(request.job) if request.job else _named(request)
        return readings(request.prompt, scene, request.target)

    def _described(self, job: str) -> SceneDescription:
        """The names in an exported scene."""
        try:
            known = job, (Path(job) / "scene.json").stat().st_mtime_ns
        except OSError:  # Live has ended, and its job is gone: the panel asks again
            return SceneDescription()
        if known != self._job:
            self._scene, self._job = described(load_scene(job)), known
        return self._scene


def readings(prompt: str, scene: SceneDescription, target: Sequence[str] = ()) -> Readings:
    """The words of a prompt as a vibe of a scene understands them.

    Args:
        prompt: What the artist has typed so far.
        target: "copper=Cup": what the artist says that words describe.
    """
    if not prompt.strip():
        return Readings(prompt)
    understood = Understood(prompt, scene, target)
    note = str(understood.unknown or "")
    if not understood.words:  # a target that cannot be is taken back by a click on its word
        understood = Understood(prompt, scene)
    return Readings(prompt, [*map(_reading, understood.words)], note)


def _named(request: AskReadings) -> SceneDescription:
    """A scene of which only names are known: everything may be the subject."""
    return SceneDescription(
        objects=dict.fromkeys(request.objects, "subject"),
        materials=dict.fromkeys((m for names in request.objects.values() for m in names), "subject"),
        object_materials={name: tuple(materials) for name, materials in request.objects.items()},
        lights={name: LightDescription(kind) for name, kind in request.lights.items()},
    )


def _reading(word: PromptWord) -> WordReading:
    """A word with what it describes; one that is not used, with known words in its place."""
    names = [candidate.name for candidate in word.candidates]
    if not word.is_used:
        unknown = not word.candidates
        others = default_vocabulary().made(Nearest).choices(word.text, _OTHERS) if unknown else []
        return WordReading(word.text, "left out", word.target, others, word.key, names, [*word.others])
    is_general = word.target in GENERAL and word.thing not in word.target
    describes = f"describes {listed(word.target)}" + (f" ({word.thing})" if is_general else "")
    if word.guess:
        state, meaning = "guessed", f"taken for “{word.guess}”, {describes}"
    else:
        state, meaning = "understood", describes
    return WordReading(word.text, state, meaning, [], word.key, names, [*word.others])
