# SPDX-License-Identifier: Apache-2.0
"""The jobs of a batch: scenes × prompts × seeds, made one at a time, so that a hundred thousand need no memory."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from .. import __version__
from ..schema import schema_hash
from .manifest import Shot

_WORDS = 32  # letters of a prompt in a folder's name


@dataclass(frozen=True)
class Job:
    """One vibe.

    Attributes:
        name: Of its folder: readable, and ending in a digest of everything that its result depends on.
        scene: As the manifest names it.
        source: Where the scene is now.
        prompt: The look.
        seed: Of every random choice.
        arguments: Options for Blender's side, with prompt and seed.
    """

    name: str
    scene: str
    source: Path
    prompt: str
    seed: int
    arguments: tuple[str, ...]


class Plan:
    """All jobs, in the order of the manifest; a new iteration makes them anew."""

    def __init__(self, shots: Sequence[Shot]) -> None:
        self.shots = shots

    def __len__(self) -> int:
        return sum(len(shot.prompts) * len(shot.seeds) for shot in self.shots)

    def __iter__(self) -> Iterator[Job]:
        for shot in self.shots:
            for prompt in shot.prompts:
                for seed in shot.seeds:
                    yield _job(shot, prompt, seed)


def _job(shot: Shot, prompt: str, seed: int) -> Job:
    arguments = (f"--prompt={prompt}", f"--seed={seed}", *shot.arguments)
    content = json.dumps([shot.name, shot.digest, arguments, __version__, schema_hash()])
    digest = hashlib.sha256(content.encode()).hexdigest()[:12]
    name = f"{_slug(Path(shot.name).stem)}-{_slug(prompt)[:_WORDS].strip('-')}-{seed}-{digest}"
    return Job(name, shot.name, shot.source, prompt, seed, arguments)


def _slug(text: str) -> str:
    """A text as a part of a file name on every system."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:48] or "x"
