# SPDX-License-Identifier: Apache-2.0
"""The manifest of `vibe batch`, checked to its last key before anything starts, and the jobs that it makes.

A mistake raises VibeError, which names its place in the file. docs/guide/batch.md has an example with all tables.
"""

from __future__ import annotations

import fnmatch
import glob
import hashlib
import json
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path
from typing import Any, Protocol

from .. import __version__
from ..inputs import check
from ..schema import VibeError, schema_hash
from ..schema.limits import LARGEST_SEED
from ..words.lexicon.vocabulary import user_file
from .manifest_options import IN_FILES, OptionReader, TomlSource, texts


def digest(path: Path) -> str:
    """SHA-256 of a file's content, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


_KNOWN = ("scenes", "prompts", "seeds", "files", "options", "limits", "scene", "shots")


@dataclass(frozen=True)
class Limits:
    """Cores, memory and time of a job."""

    minutes: float = 60.0  # of wall time; a job that takes longer is ended
    # of Blender and the engine together; a job that uses more is ended. The number of workers is so that each can have
    # as much
    memory_gb: float = 6.0
    cores: int = 2  # threads of the engine: the same number gives the same values, bit for bit, everywhere
    retries: int = 1  # times that a failed job is tried again
    free_gb: float = 1.0  # of disk space; no job is started below that


@dataclass(frozen=True)
class SceneGroup:
    """A scene of the manifest, or several that are to share a look."""

    # path of a single scene from the manifest's folder, with forward slashes; of several, their name in the manifest
    name: str
    source: Path  # path of the scene, or of the first
    digest: str  # of the scenes' content, and of all other files that the result depends on
    prompts: tuple[str, ...]  # each is tried with each seed
    seeds: tuple[int, ...]
    arguments: tuple[str, ...]  # options for Blender's side, without prompt and seed
    more: tuple[Path, ...] = ()  # paths of the other scenes


def load(path: Path, out: Path) -> tuple[BatchPlan, Limits]:
    """Reads and checks a manifest; scenes that patterns match in the results folder are left out."""
    check.file(str(path), "manifest")
    return _Reader(TomlSource(path.expanduser()), out.expanduser().resolve()).manifest()


class _Reader:
    def __init__(self, source: TomlSource, out: Path) -> None:
        self._source, self._problem, self._content = source, source.problem, source.content
        self._base, self._out = source.path.parent.resolve(), out
        self._options = OptionReader(source, self._base)

    def manifest(self) -> tuple[BatchPlan, Limits]:
        content = self._content
        for key in content:
            if key not in _KNOWN:
                raise self._problem(f"Unknown key {key!r}.", f"Use {', '.join(_KNOWN)}.", key)
        limits = self._limits(content.get("limits", {}))
        common = self._options.read(self._table(content, "options"), ("options",))
        everything = self._common_digest(content.get("files", []), common.get("vocabulary", ""))
        groups = [*self._single(common, everything), *self._together(common, everything)]
        return BatchPlan(groups), limits

    def _single(self, common: dict[str, Any], everything: str) -> Iterator[SceneGroup]:
        if self._content.get("scenes", []) == [] and "shots" in self._content:
            return
        scenes = dict(self._scenes(self._content.get("scenes"), "scenes"))
        named = self._table(self._content, "scene")
        for pattern in named:
            if not fnmatch.filter(scenes, pattern):
                remedy = f"Scenes are named as in {next(iter(scenes))}."
                raise self._problem(f"No scene matches {pattern!r}.", remedy, "scene", pattern)
        for name, place in scenes.items():
            own: dict[str, Any] = {}
            for pattern, table in named.items():
                if fnmatch.fnmatch(name, pattern):
                    own |= self._own(table, common, "scene", pattern)
            yield self._group(name, [place], common, own, everything)

    def _together(self, common: dict[str, Any], everything: str) -> Iterator[SceneGroup]:
        """The groups of shots that share a look."""
        names: set[str] = set()
        for number, table in enumerate(self._content.get("shots", []), 1):
            keys = ("shots", str(number))
            name = table.get("name") if isinstance(table, dict) else None
            if not isinstance(name, str) or not name.strip() or name in names:
                problem = "Shots that share a look need a name of their own."
                raise self._problem(problem, 'Write name = "kitchen".', *keys)
            names.add(name)
            scenes = [place for _, place in self._scenes(table.get("scenes"), *keys, "scenes")]
            rest = {k: v for k, v in table.items() if k not in ("name", "scenes")}
            own = self._own(rest, common, *keys)
            with self._source.at(*keys):
                group = self._group(name, scenes, common, own, everything)
            yield group

    def _group(
        self, name: str, scenes: list[Path], common: dict[str, Any], own: dict[str, Any], everything: str
    ) -> SceneGroup:
        options = common | own
        arguments = self._options.arguments(options, scenes)
        prompts = own.get("prompts") or self._prompts(self._content.get("prompts"), options, "prompts")
        seeds = own.get("seeds") or self._seeds(self._content.get("seeds", [0]), "seeds")
        read = [Path(options[name]) for name in IN_FILES if options.get(name)]
        content = " ".join([*map(digest, [*scenes, *read]), everything])
        mark = hashlib.sha256(content.encode()).hexdigest()
        return SceneGroup(name, scenes[0], mark, prompts, seeds, arguments, tuple(scenes[1:]))

    def _table(self, content: dict[str, Any], key: str) -> dict[str, Any]:
        table = content.get(key, {})
        if not isinstance(table, dict):
            raise self._problem(f"{key!r} is not a table.", f"Write [{key}] above its rows.", key)
        return table

    def _prompts(self, given: Any, options: dict[str, Any], *keys: str) -> tuple[str, ...]:
        """Prompts from a list, or from a file with one on each line; with a reference image or goals, they may be missing."""
        if given is None and any(options.get(name) for name in IN_FILES):
            return ("",)
        if isinstance(given, str):
            return self._prompts_of_file(self._named(given, "list of prompts", *keys), options)
        if not texts(given):
            remedy = 'Write prompts = ["noir", "misty"], or prompts = "prompts.txt".'
            raise self._problem("There are no prompts.", remedy, *keys)
        for prompt in given:
            with self._source.at(*keys, prompt):
                self._options.prompt(prompt, options)
        return tuple(dict.fromkeys(given))

    def _prompts_of_file(self, path: Path, options: dict[str, Any]) -> tuple[str, ...]:
        prompts: dict[str, None] = {}
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
            prompt = line.strip()
            if not prompt or prompt.startswith("#"):
                continue
            try:
                self._options.prompt(prompt, options)
            except VibeError as error:
                raise VibeError(f"{path}, line {number}: {error.message}", error.remedy) from error
            prompts[prompt] = None
        if not prompts:
            raise VibeError(f"{path} holds no prompt.", "Write one on each line.")
        return tuple(prompts)

    def _seeds(self, given: Any, *keys: str) -> tuple[int, ...]:
        seeds = given if isinstance(given, list) else ()
        if not seeds or not all(type(s) is int and 0 <= s <= LARGEST_SEED for s in seeds):
            raise self._problem("These are not seeds.", "Write numbers from 0: seeds = [0, 1].", *keys)
        return tuple(dict.fromkeys(given))

    def _own(self, table: Any, options: dict[str, Any], *keys: str) -> dict[str, Any]:
        """Options, prompts and seeds in a table for some scenes, "scene" or "shots"."""
        if not isinstance(table, dict):
            raise self._problem("This is not a table.", f'Write [scene."{keys[-1]}"].', *keys)
        rest = {k: v for k, v in table.items() if k not in ("prompts", "seeds")}
        if "vocabulary" in rest:
            raise self._problem("A scene has no vocabulary of its own.", "Put it under [options].", *keys)
        own = self._options.read(rest, keys, keys[0])
        if "prompts" in table:
            own["prompts"] = self._prompts(table["prompts"], options | own, *keys, "prompts")
        if "seeds" in table:
            own["seeds"] = self._seeds(table["seeds"], *keys, "seeds")
        return own

    def _limits(self, table: Any) -> Limits:
        defaults = {f.name: f.default for f in fields(Limits)}
        for key, value in table.items() if isinstance(table, dict) else ():
            if key not in defaults:
                raise self._problem(f"Unknown limit {key!r}.", f"Use {', '.join(defaults)}.", "limits", key)
            whole = isinstance(defaults[key], int)
            least = 0.01 if key in ("minutes", "cores") else 0.0
            if type(value) not in ((int,) if whole else (int, float)) or value < least:
                remedy = f"Write a {'whole number' if whole else 'number'}, as in {key} = {defaults[key]}."
                raise self._problem(f"{key} cannot be {value!r}.", remedy, "limits", key)
        return Limits(**self._table({"limits": table}, "limits"))

    def _scenes(self, patterns: Any, *keys: str) -> Iterator[tuple[str, Path]]:
        """The scenes that patterns match, in the order of the manifest: for each, its name in the results and its path."""
        if not texts(patterns):
            raise self._problem("There are no scenes.", 'Write scenes = ["shots/*.blend"].', *keys)
        for pattern in patterns:
            places = sorted(glob.glob(pattern, root_dir=self._base, recursive=True))
            if glob.has_magic(pattern):
                places = [p for p in places if Path(p).suffix.lower() in check.SCENES]
            places = [p for p in places if not (self._base / p).resolve().is_relative_to(self._out)]
            if not places:
                remedy = f"It is looked for from {self._base}; scenes are {' '.join(check.SCENES)} files."
                raise self._problem(f"No scene matches {pattern!r}.", remedy, *keys, pattern)
            for place in places:
                with self._source.at(*keys, pattern):
                    scene = check.scene(str(self._base / place))
                yield Path(os.path.relpath(self._base / place, self._base)).as_posix(), scene

    def _common_digest(self, patterns: Any, vocabulary: str) -> str:
        """Digest of what every result depends on: the manifest's `files` and the user's vocabulary."""
        if patterns and not texts(patterns):
            raise self._problem("These are not files.", 'Write files = ["textures/**"].', "files")
        linked = []
        for pattern in patterns:
            matches = sorted(glob.glob(pattern, root_dir=self._base, recursive=True))
            linked += [p for p in matches if (self._base / p).is_file()]
            if not matches:
                remedy = f"It is looked for from {self._base}."
                raise self._problem(f"No file matches {pattern!r}.", remedy, "files", pattern)
        if vocabulary:
            self._named(vocabulary, "vocabulary", "options", "vocabulary")
        words = user_file()
        lines = [f"{p} {digest(self._base / p)}" for p in linked] + ([digest(words)] if words else [])
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()

    def _named(self, name: str, what: str, *keys: str) -> Path:
        """The path of a file that the manifest names. Raises VibeError if it cannot be read."""
        with self._source.at(*keys):
            return check.file(str(self._base / name), what)


# The jobs of a batch: scenes × prompts × seeds, made one at a time


_WORDS, _DIGEST = 32, 12  # characters of a prompt, and of the digest, in a folder's name
_FILES = tuple(f"--{name}=" for name in IN_FILES)


@dataclass(frozen=True)
class Take:
    """Final frames of one .blend through one camera."""

    blend: int  # its number among the job's scenes
    camera: str = ""  # its name; "" for the .blend's own
    frames: str = ""  # "1-24" or "1,50"; "" for the .blend's own
    folder: str = ""  # subfolder for its frames in the job's folder of frames; "" for that folder itself


@dataclass(frozen=True)
class Job:
    """One vibe, or the final frames of its result."""

    name: str  # of its folder: readable, and ending in a digest of everything that its result depends on
    scene: str  # as the manifest names it
    source: Path  # path of the scene, or of the first
    prompt: str  # the look
    seed: int  # of every random choice
    arguments: tuple[str, ...]  # options for Blender's side, with prompt and seed
    more: tuple[Path, ...] = ()  # paths of the other scenes that are to have the same look
    # None for a vibe; otherwise the final frames that the job renders of its result: "1-24", "" for the scene's own
    frames: str | None = None
    takes: tuple[Take, ...] = ()  # these frames, for every .blend and camera of the result; empty for a vibe


class Jobs(Protocol):
    """Jobs that every iteration creates anew, one at a time."""

    def __len__(self) -> int: ...

    def __iter__(self) -> Iterator[Job]: ...


class BatchPlan:
    """All jobs, in the order of the manifest; every iteration creates them anew."""

    def __init__(self, groups: Sequence[SceneGroup]) -> None:
        self.groups = groups

    def __len__(self) -> int:
        return sum(len(group.prompts) * len(group.seeds) for group in self.groups)

    def __iter__(self) -> Iterator[Job]:
        version = f"{__version__} {schema_hash()}"
        for group in self.groups:
            # The paths of reference image and goals are left out: the group's digest covers their content.
            options = [each for each in group.arguments if not each.startswith(_FILES)]
            base = hashlib.sha256(json.dumps([group.name, group.digest, options, version]).encode())
            stem = _slug(Path(group.name).stem)
            for prompt in group.prompts:
                # Without a prompt the job is named after the options for its files: "like", "goals".
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
