# SPDX-License-Identifier: Apache-2.0
"""Reads the manifest of `vibe batch`, checks all of its keys before anything starts, and lists its jobs.

A mistake raises VibeError, which names its place in the file. docs/guide/batch.md has an example with all tables.
"""

import argparse
import fnmatch
import glob
import hashlib
import json
import os
import re
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from functools import lru_cache
from pathlib import Path
from typing import Any

from .. import __version__
from ..inputs import check
from ..schema import VibeError, frame_numbers, schema_hash
from ..schema.limits import LARGEST_SEED
from ..schema.options import checks
from ..schema.options.table import TABLE, Option, to_arguments
from ..words.lexicon.vocabulary import user_file


def digest(path: Path) -> str:
    """SHA-256 of a file's content, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


IN_FILES = ("like", "goals")  # options that name a file which sets the look, with a prompt or without one
_ELSEWHERE = {"seed": "Write seeds = [0, 1] at the top."}
_KNOWN = ("scenes", "prompts", "seeds", "files", "options", "limits", "scene", "shots")
_WORDS, _DIGEST = 32, 12  # characters of a prompt, and of the digest, in a folder's name
_FILES = tuple(f"--{name}=" for name in IN_FILES)


class TomlSource:
    """A TOML file that has been read: its `path` as it was given, and its `content`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            self.content: dict[str, Any] = tomllib.loads(path.read_text("utf-8"))
        except tomllib.TOMLDecodeError as error:
            raise VibeError(f"{path} is not TOML: {error}.", "Mend that line.") from error
        except (OSError, UnicodeDecodeError) as error:
            raise VibeError(f"{path} cannot be read: {error}.", "Save it as UTF-8 text.") from error

    def problem(self, what: str, remedy: str, *place: str) -> VibeError:
        """An error, not yet raised, that names the file and a `place` in it: keys, outermost first, and a value."""
        return VibeError(f"{' > '.join(filter(None, (str(self.path), *place)))}: {what}", remedy)

    @contextmanager
    def at(self, *place: str) -> Iterator[None]:
        """Adds the file and a `place` in it (see `problem`) to the VibeErrors raised inside the block."""
        try:
            yield
        except VibeError as error:
            raise self.problem(error.message, error.remedy, *place) from error


class OptionReader:
    """Reads and checks the manifest's tables of options; paths in them start from the folder `base`."""

    def __init__(self, source: TomlSource, base: Path, options: Iterable[Option] = TABLE) -> None:
        self._source, self._problem, self._base = source, source.problem, base
        self._rows = {row.name: row for row in options}
        self._defaults = {row.name: row.command_default for row in self._rows.values() if row.name != "stage"}

    def read(self, table: dict[str, Any], keys: tuple[str, ...], where: str = "") -> dict[str, Any]:
        """The options in a table of the manifest, checked for type and value.

        `keys`: the table's place, for errors. `where`: "scene" or "shots" for a table of some scenes, "" for [options].
        """
        # Tables of scenes and of shots allow a few more options than [options] does.
        rows = {n: row for n, row in self._rows.items() if {"options", where} & set(row.manifest)}
        options: dict[str, Any] = {}
        for key, value in table.items():
            name = key.replace("-", "_")
            if name not in rows:
                remedy = _ELSEWHERE.get(name, f"Use {', '.join(sorted(rows))}.")
                raise self._problem(f"Unknown option {key!r}.", remedy, *keys, key)
            options[name] = self._value(rows[name], key, value, keys)
        return options

    def _value(self, row: Option, key: str, value: Any, keys: tuple[str, ...]) -> Any:
        """The value of option `row`, checked, in the type that a parsed command line has; `keys` as for `read`."""
        several = isinstance(row.default, tuple)
        if several and isinstance(value, str):
            value = [value]
        if row.name == "frames" and isinstance(value, list):
            value = ",".join(map(str, value))
        if type(value) is not (list if several else type(row.default)) or (several and not texts(value)):
            shown = {bool: "false", tuple: '["a", "b"]', str: '"text"'}
            example = "[1, 50, 100]" if row.name == "frames" else shown.get(type(row.default), row.default)
            remedy = f"Write it as in {row.name} = {example}."
            raise self._problem(f"{key} cannot be {value!r}.", remedy, *keys, key)
        if row.choices and value not in row.choices:
            raise self._problem(f"{key} cannot be {value!r}.", f"Use {', '.join(row.choices)}.", *keys, key)
        with self._source.at(*keys, key):
            given = argparse.Namespace(**self._defaults | {row.name: value})
            checks.numbers(given, self._rows.values())
            checks.groups(given.groups)
            checks.locks(given.lock)
            checks.targets(given.target)
            checks.traits(given.like_only, given.like or "perhaps in another table")
            check.device(given.device)
            frame_numbers(getattr(given, "frames", ""))
            if given.vocabulary:
                check.vocabulary(str(self._base / given.vocabulary))
            if row.name in IN_FILES and isinstance(value, str) and value:
                path = str(self._base / value)
                value = str(check.file(path, "picture")) if row.name == "like" else check.goals(path)
        return value

    def prompt(self, prompt: str, options: dict[str, Any]) -> None:
        """Raises VibeError for a prompt that `vibe run` would refuse."""
        checks.prompt(prompt, options.get("like", ""), options.get("goals", ""))
        if prompt.strip():
            check.words(prompt, argparse.Namespace(**self._defaults | options))

    def arguments(self, options: dict[str, Any], scenes: list[Path]) -> tuple[str, ...]:
        """Arguments for Blender's side (`batch.py`) from a job's options, without prompt and seed."""
        given = argparse.Namespace(**self._defaults | options)
        checks.numbers(given, self._rows.values())
        given.groups = checks.groups(given.groups)
        checks.traits(given.like_only, given.like)
        check.shots(scenes, given)
        if scenes[0].suffix.lower() == ".blend":
            given.stage = ""
        rows = [row for row in self._rows.values() if row.name not in ("prompt", "seed")]
        return tuple(to_arguments(given, rows))


def texts(given: Any) -> bool:
    """True for a list of texts that is not empty."""
    return isinstance(given, list) and bool(given) and all(isinstance(text, str) for text in given)


@dataclass(frozen=True)
class Limits:
    """Cores, memory and time of a job."""

    minutes: float = 60.0  # of wall time; a job that takes longer is ended
    memory_gb: float = 6.0  # of Blender and the engine together, for each worker; a job that uses more is ended
    cores: int = 2  # threads of the engine: the same number gives the same values, bit for bit, everywhere
    retries: int = 1  # times that a failed job is tried again
    free_gb: float = 1.0  # of disk space; no job is started below that


@dataclass(frozen=True)
class SceneGroup:
    """A scene of the manifest, or several that are to share a look."""

    name: str  # path from the manifest's folder, with forward slashes; of several scenes, their name in the manifest
    source: Path  # path of the scene, or of the first
    digest: str  # of the scenes' content, and of all other files that the result depends on
    prompts: tuple[str, ...]  # each is tried with each seed
    seeds: tuple[int, ...]
    arguments: tuple[str, ...]  # options for Blender's side, without prompt and seed
    more: tuple[Path, ...] = ()  # paths of the other scenes


def load(path: Path, out: Path) -> tuple["BatchPlan", Limits]:
    """Reads and checks a manifest; scenes that patterns match in the results folder are left out."""
    check.file(str(path), "manifest")
    return _Reader(TomlSource(path.expanduser()), out.expanduser().resolve()).manifest()


class _Reader(OptionReader):
    def __init__(self, source: TomlSource, out: Path) -> None:
        super().__init__(source, source.path.parent.resolve())
        self._content, self._out = source.content, out

    def manifest(self) -> tuple["BatchPlan", Limits]:
        for key in self._content:
            if key not in _KNOWN:
                raise self._problem(f"Unknown key {key!r}.", f"Use {', '.join(_KNOWN)}.", key)
        limits, defaults = self._table("limits"), {f.name: f.default for f in fields(Limits)}
        for key, value in limits.items():
            if key not in defaults:
                raise self._problem(f"Unknown limit {key!r}.", f"Use {', '.join(defaults)}.", "limits", key)
            whole = isinstance(defaults[key], int)
            least = 0.01 if key in ("minutes", "cores") else 0.0
            if type(value) not in ((int,) if whole else (int, float)) or value < least:
                remedy = f"Write a {'whole number' if whole else 'number'}, as in {key} = {defaults[key]}."
                raise self._problem(f"{key} cannot be {value!r}.", remedy, "limits", key)
        common = self.read(self._table("options"), ("options",))
        everything = self._common_digest(self._content.get("files", []), common.get("vocabulary", ""))
        plan = BatchPlan([*self._single(common, everything), *self._together(common, everything)])
        return plan, Limits(**limits)

    def _single(self, common: dict[str, Any], everything: str) -> Iterator[SceneGroup]:
        if self._content.get("scenes", []) == [] and "shots" in self._content:
            return
        scenes = dict(self._scenes(self._content.get("scenes"), "scenes"))
        named = self._table("scene")
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
                remedy = 'Write name = "kitchen".'
                raise self._problem("Shots that share a look need a name of their own.", remedy, *keys)
            names.add(name)
            scenes = [place for _, place in self._scenes(table.get("scenes"), *keys, "scenes")]
            own = self._own({k: v for k, v in table.items() if k not in ("name", "scenes")}, common, *keys)
            with self._source.at(*keys):
                group = self._group(name, scenes, common, own, everything)
            yield group

    def _group(
        self, name: str, scenes: list[Path], common: dict[str, Any], own: dict[str, Any], everything: str
    ) -> SceneGroup:
        options = common | own
        arguments = self.arguments(options, scenes)
        prompts = own.get("prompts") or self._prompts(self._content.get("prompts"), options, "prompts")
        seeds = own.get("seeds") or self._seeds(self._content.get("seeds", [0]), "seeds")
        read = [Path(options[name]) for name in IN_FILES if options.get(name)]
        mark = hashlib.sha256(" ".join([*map(digest, [*scenes, *read]), everything]).encode()).hexdigest()
        return SceneGroup(name, scenes[0], mark, prompts, seeds, arguments, tuple(scenes[1:]))

    def _table(self, key: str) -> dict[str, Any]:
        table = self._content.get(key, {})
        if not isinstance(table, dict):
            raise self._problem(f"{key!r} is not a table.", f"Write [{key}] above its rows.", key)
        return table

    def _prompts(self, given: Any, options: dict[str, Any], *keys: str) -> tuple[str, ...]:
        """Prompts from `given`, a list or the name of a file; ("",) for None, if `options` name an image or goals."""
        if given is None and any(options.get(name) for name in IN_FILES):
            return ("",)
        if isinstance(given, str):
            with self._source.at(*keys):
                path = check.file(str(self._base / given), "list of prompts")
            prompts: dict[str, None] = {}
            for number, line in enumerate(map(str.strip, path.read_text("utf-8").splitlines()), 1):
                if line and not line.startswith("#"):
                    prompts[line] = None
                    try:
                        self.prompt(line, options)
                    except VibeError as error:
                        raise VibeError(f"{path}, line {number}: {error.message}", error.remedy) from error
            if not prompts:
                raise VibeError(f"{path} holds no prompt.", "Write one on each line.")
            return tuple(prompts)
        if not texts(given):
            remedy = 'Write prompts = ["noir", "misty"], or prompts = "prompts.txt".'
            raise self._problem("There are no prompts.", remedy, *keys)
        for prompt in given:
            with self._source.at(*keys, prompt):
                self.prompt(prompt, options)
        return tuple(dict.fromkeys(given))

    def _seeds(self, given: Any, *keys: str) -> tuple[int, ...]:
        seeds = given if isinstance(given, list) else ()
        if not seeds or not all(type(s) is int and 0 <= s <= LARGEST_SEED for s in seeds):
            raise self._problem("These are not seeds.", "Write numbers from 0: seeds = [0, 1].", *keys)
        return tuple(dict.fromkeys(given))

    def _own(self, table: Any, options: dict[str, Any], *keys: str) -> dict[str, Any]:
        """Options, prompts and seeds in a table for some scenes; `options` are those for all, `keys` its place."""
        if not isinstance(table, dict):
            raise self._problem("This is not a table.", f'Write [scene."{keys[-1]}"].', *keys)
        rest = {k: v for k, v in table.items() if k not in ("prompts", "seeds")}
        if "vocabulary" in rest:
            raise self._problem("A scene has no vocabulary of its own.", "Put it under [options].", *keys)
        own = self.read(rest, keys, keys[0])
        if "prompts" in table:
            own["prompts"] = self._prompts(table["prompts"], options | own, *keys, "prompts")
        if "seeds" in table:
            own["seeds"] = self._seeds(table["seeds"], *keys, "seeds")
        return own

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
            with self._source.at("options", "vocabulary"):
                check.file(str(self._base / vocabulary), "vocabulary")
        words = user_file()
        lines = [f"{p} {digest(self._base / p)}" for p in linked] + ([digest(words)] if words else [])
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


@dataclass(frozen=True)
class Take:
    """Final frames of one .blend through one camera."""

    blend: int  # index among the job's scenes: 0 for `Job.source`
    camera: str = ""  # its name; "" for the .blend's own
    frames: str = ""  # "1-24" or "1,50"; "" for the .blend's own
    folder: str = ""  # subfolder for the frames in the job's folder `frames`; "" for `frames` itself


@dataclass(frozen=True)
class Job:
    """One vibe, or the rendering of final frames of its result."""

    name: str  # of the job's folder: readable, and ending in a digest of everything that the result depends on
    scene: str  # as the manifest names it
    source: Path  # path of the scene, or of the first
    prompt: str  # the look
    seed: int  # of every random choice
    arguments: tuple[str, ...]  # options for Blender's side, with prompt and seed
    more: tuple[Path, ...] = ()  # paths of the other scenes that are to have the same look
    frames: str | None = None  # final frames of its result to render: "1-24", "" for the scene's own; None for a vibe
    takes: tuple[Take, ...] = ()  # renders of `frames`, one for each .blend and camera of the result; () for a vibe


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
    """A text as a part of a file name on every system: at most 48 of a-z, 0-9 and "-"; "x" if none is left."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:48] or "x"
