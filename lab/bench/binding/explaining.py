# SPDX-License-Identifier: Apache-2.0
"""Time of `vibe explain` for a prompt of some forty words, once the scene is known and word vectors are loaded."""

from __future__ import annotations

import time
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import groupby
from typing import Any

from lab.bench.binding import table
from lab.train.sentences.labels import LabeledScene, LabeledSentence
from lab.train.sentences.stand_in import SceneStandIn, stand_in
from proxy_renderer.goals.resolve import goals_or_why
from proxy_renderer.planning.advice import OfflineAdvisor, explain
from proxy_renderer.schema import VibeError
from proxy_renderer.words.parser import Understood
from proxy_renderer.words.types import Parsed

_LEAST, _MOST = 35, 45  # words of a prompt that counts as one of forty


def measured(sentences: Sequence[LabeledSentence]) -> dict[str, Any]:
    """Times prompts of 35 to 45 words, which are sentences about one scene, one after another.

    Args:
        sentences: In the order of their scenes.

    Returns:
        `prompts`: how many; `median` and `percentile_90` of their times, in milliseconds of the processor, which other work
            on the machine hardly lengthens; none of these without prompts.
    """
    seconds = [each for scene, texts in _by_scene(sentences) for each in _times(scene, _joined(texts))]
    return {"prompts": len(seconds), **(table.milliseconds(seconds) if seconds else {})}


def explained(text: str, whole: SceneStandIn) -> Parsed:
    """Reads, binds, plans and accounts for a prompt, as `vibe explain` does with a scene at hand.

    Raises:
        VibeError: The prompt asks for no look.
    """
    advice = OfflineAdvisor(goals_or_why(Understood(text, whole.scene))).advise(None, whole.instances, whole.scene)
    explain(advice.goals, advice.prompts, advice.plan)
    return advice.goals.parsed


def _by_scene(sentences: Sequence[LabeledSentence]) -> Iterator[tuple[LabeledScene, list[str]]]:
    ordered = sorted(sentences, key=lambda s: s.scene.name)
    for _, group in groupby(ordered, key=lambda s: s.scene.name):
        mine = list(group)
        yield mine[0].scene, [s.text for s in mine]


def _joined(texts: Iterable[str]) -> Iterator[str]:
    """Prompts of forty words; what would make one too long begins the next."""
    parts: list[str] = []
    for text in texts:
        if sum(len(part.split()) for part in (*parts, text)) > _MOST:
            parts = []
        parts.append(text.rstrip(". "))
        if _LEAST <= sum(len(part.split()) for part in parts) <= _MOST:
            yield ". ".join(parts)
            parts = []


def _times(scene: LabeledScene, texts: Iterable[str]) -> Iterator[float]:
    """Seconds of the processor for each; to refuse one takes time as well."""
    whole = stand_in(scene)
    for text in texts:
        start = time.process_time()
        with suppress(VibeError):
            explained(text, whole)
        yield time.process_time() - start
