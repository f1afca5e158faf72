# SPDX-License-Identifier: Apache-2.0
"""The jobs of a batch: scenes × prompts × seeds, made one at a time, so that a hundred thousand need no memory."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Protocol

from .. import __version__
from ..schema import schema_hash
from .manifest import SceneGroup
from .manifest_options import IN_FILES

_WORDS, _DIGEST = 32, 12  # letters of a prompt, and of the digest, in a folder's name
_FILES = tuple(f"--{name}=" for name in IN_FILES)


@dataclass(frozen=True)
class Take:
    """Final frames of one .blend through one camera."""

    blend: int  # its number among the job's scenes
    camera: str = ""  # its name; "" for the .blend's own
    frames: str = ""  # "1-24" or "1,50"; "" for the .blend's own
    folder: str = ""  # for its frames, in that of the job's frames; "" for that itself


@dataclass(frozen=True)
class Job:
    """One vibe."""

    name: str  # of its folder: readable, and ending in a digest of everything that its result depends on
    scene: str  # as the manifest names it
    source: Path  # where the scene is now
    prompt: str  # the look
    seed: int  # of every random choice
    arguments: tuple[str, ...]  # options for Blender's side, with prompt and seed
    more: tuple[Path, ...] = ()  # where the other scenes are that are to have the same look
    # None for a vibe; else the final frames of its result to render: "1-24", "" for the scene's own
    frames: str | None = None
    takes: tuple[Take, ...] = ()  # the same, for every .blend and camera of the result


class Jobs(Protocol):
    """Jobs that are made when they are asked for, again and again."""

    def __len__(self) -> int: ...

    def __iter__(self) -> Iterator[Job]: ...


class BatchPlan:
    """All jobs, in the order of the manifest; a new iteration makes them anew."""

    def __init__(self, groups: Sequence[SceneGroup]) -> None:
        self.groups = groups

    def __len__(self) -> int:
        return sum(len(group.prompts) * len(group.seeds) for group in self.groups)

    def __iter__(self) -> Iterator[Job]:
        version = f"{__version__} {schema_hash()}"
        for group in self.groups:
            # Where the picture and the goals lie does not matter: the group's digest knows what is in them.
            options = [each for each in group.arguments if not each.startswith(_FILES)]
            base = hashlib.sha256(json.dumps([group.name, group.digest, options, version]).encode())
            stem = _slug(Path(group.name).stem)
            for prompt in group.prompts:
                # Without a prompt it is called after its files: "like", "goals".
                files = (n for n in IN_FILES if any(a.startswith(f"--{n}=") for a in group.arguments))
                words = _slug(prompt or "-".join(files))[:_WORDS].strip("-")
                for seed in group.seeds:
                    digest = base.copy()
                    digest.update(f" {seed} {prompt}".encode())
                    arguments = (f"--prompt={prompt}", f"--seed={seed}", *group.arguments)
                    name = f"{stem}-{words}-{seed}-{digest.hexdigest()[:_DIGEST]}"
                    yield Job(name, group.name, group.source, prompt, seed, arguments, group.more)


@lru_cache(4096)
def _slug(text: str) -> str:
    """A text as a part of a file name on every system."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:48] or "x"
