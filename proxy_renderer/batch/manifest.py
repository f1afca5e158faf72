# SPDX-License-Identifier: Apache-2.0
"""The manifest of `vibe batch`, checked to its last key before anything starts.

scenes = ["shots/*.blend", "props/teapot.obj"]      # beside the manifest; ** goes into folders
prompts = ["noir", "golden hour, warm haze"]        # or the name of a text file, a prompt on each line
seeds = [0, 1]                                      # default: [0]
files = ["textures/**"]                             # what scenes link to: if it changes, they are done again

[options]                                           # those of `vibe run`
size = 512
lock = ["material/*"]

[limits]                                            # of each job, and of the machine: see `Limits`
minutes = 30

[scene."shots/010*"]                                # for the scenes whose name matches
prompts = ["noir"]
subject = ["Hero"]
samples = 256
"""

from __future__ import annotations

import argparse
import fnmatch
import glob
import hashlib
import os
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from .. import check
from ..arguments import add_vibe_options, vibe_arguments
from ..language.user import user_file
from ..schema import VibeError, budgets
from .toml_source import Source

_OF_SCENE = {"subject": [], "stage": ""}
"""What a scene may have besides the options of a vibe."""

_ELSEWHERE = {"seed": "Write seeds = [0, 1] at the top."}


@dataclass(frozen=True)
class Limits:
    """What a job may use.

    Attributes:
        minutes: Of wall time; it is ended after that.
        memory_gb: Of Blender and the engine together; it is ended above that. As many workers are started as fit.
        cores: Threads of the engine. The same number gives the same values, bit for bit, on any machine.
        retries: Times that a failed job is tried again.
        free_gb: Of disk space; no job is started below that.
    """

    minutes: float = 60.0
    memory_gb: float = 6.0
    cores: int = 2
    retries: int = 1
    free_gb: float = 1.0


@dataclass(frozen=True)
class Shot:
    """A scene of the manifest.

    Attributes:
        name: Its path from the manifest's folder, with forward slashes.
        source: Where it is now.
        digest: Of its content, and of what else the result depends on.
        prompts: To be tried on it.
        seeds: Likewise.
        arguments: Options for Blender's side, without prompt and seed.
    """

    name: str
    source: Path
    digest: str
    prompts: tuple[str, ...]
    seeds: tuple[int, ...]
    arguments: tuple[str, ...]


@dataclass(frozen=True)
class Manifest:
    """What is wanted."""

    shots: tuple[Shot, ...]
    limits: Limits


def load(path: Path, out: Path) -> Manifest:
    """Reads and checks a manifest; scenes under the results folder `out` are none of it.

    Raises:
        VibeError: Something in it is wrong; names the file, the line and the remedy.
    """
    check.file(str(path), "manifest")
    return _Reader(Source(path.expanduser()), out.expanduser().resolve()).manifest()


class _Reader:
    def __init__(self, source: Source, out: Path) -> None:
        self._source, self._out = source, out
        self._base = source.path.parent.resolve()
        parser = argparse.ArgumentParser(add_help=False)
        add_vibe_options(parser)
        self._defaults = vars(parser.parse_args([]))
        self._choices = {a.dest: tuple(a.choices or ()) for a in parser._actions} | {"stage": check.STAGES}

    def manifest(self) -> Manifest:
        content = self._source.content
        known = ("scenes", "prompts", "seeds", "files", "options", "limits", "scene")
        for key in content:
            if key not in known:
                raise self._problem(f"Unknown key {key!r}.", f"Use {', '.join(known)}.", key)
        limits = self._limits(content.get("limits", {}))
        options = self._options(self._table(content, "options"), ("options",), {})
        seeds = self._seeds(content.get("seeds", [0]), "seeds")
        everything = self._common(options)
        named = self._table(content, "scene")
        found = dict(self._scenes())
        for pattern in named:
            if not fnmatch.filter(found, pattern):
                remedy = f"Scenes are named as in {next(iter(found))}."
                raise self._problem(f"No scene matches {pattern!r}.", remedy, "scene", pattern)
        shots = []
        for name, place in found.items():
            own = {k: v for pattern, table in named.items() if fnmatch.fnmatch(name, pattern)
                   for k, v in self._own(pattern, table, options).items()}  # fmt: skip
            arguments = self._arguments(options | own, place)
            prompts = own.get("prompts") or self._prompts(content.get("prompts"), options, "prompts")
            digest = hashlib.sha256(f"{_digest(place)} {everything}".encode()).hexdigest()
            shots.append(Shot(name, place, digest, prompts, own.get("seeds") or seeds, arguments))
        return Manifest(tuple(shots), limits)

    def _problem(self, what: str, remedy: str, *keys: str, quoted: str = "") -> VibeError:
        return self._source.problem(what, remedy, *keys, quoted=quoted)

    def _table(self, content: dict[str, Any], key: str) -> dict[str, Any]:
        table = content.get(key, {})
        if not isinstance(table, dict):
            raise self._problem(f"{key!r} is not a table.", f"Write [{key}] above its rows.", key)
        return table

    def _scenes(self) -> Iterator[tuple[str, Path]]:
        """Names and places, in the order of the manifest."""
        patterns = self._source.content.get("scenes")
        if not _texts(patterns):
            raise self._problem("There are no scenes.", 'Write scenes = ["shots/*.blend"].', "scenes")
        for pattern in patterns:  # type: ignore[union-attr]
            places = sorted(glob.glob(pattern, root_dir=self._base, recursive=True))
            if glob.has_magic(pattern):
                places = [p for p in places if Path(p).suffix.lower() in check.SCENES]
            places = [p for p in places if not (self._base / p).resolve().is_relative_to(self._out)]
            if not places:
                remedy = f"It is looked for from {self._base}; scenes are {' '.join(check.SCENES)} files."
                raise self._problem(f"No scene matches {pattern!r}.", remedy, "scenes", quoted=pattern)
            for place in places:
                try:
                    found = check.scene(str(self._base / place))
                except VibeError as error:
                    raise self._problem(error.message, error.remedy, "scenes", quoted=pattern) from error
                yield Path(os.path.relpath(self._base / place, self._base)).as_posix(), found

    def _prompts(self, given: Any, options: dict[str, Any], *keys: str) -> tuple[str, ...]:
        """Prompts from a list, or from a file with one on each line."""
        if isinstance(given, str):
            return self._prompts_of_file(self._file(given, "list of prompts", *keys), options)
        if not _texts(given):
            remedy = 'Write prompts = ["noir", "misty"], or prompts = "prompts.txt".'
            raise self._problem("There are no prompts.", remedy, *keys)
        for prompt in given:
            try:
                self._check_prompt(prompt, options)
            except VibeError as error:
                raise self._problem(error.message, error.remedy, *keys, quoted=prompt) from error
        return tuple(dict.fromkeys(given))

    def _prompts_of_file(self, path: Path, options: dict[str, Any]) -> tuple[str, ...]:
        found: dict[str, None] = {}
        for number, line in enumerate(path.read_text("utf-8").splitlines(), 1):
            prompt = line.strip()
            if not prompt or prompt.startswith("#"):
                continue
            try:
                self._check_prompt(prompt, options)
            except VibeError as error:
                raise VibeError(f"{path}, line {number}: {error.message}", error.remedy) from error
            found[prompt] = None
        if not found:
            raise VibeError(f"{path} holds no prompt.", "Write one on each line.")
        return tuple(found)

    def _check_prompt(self, prompt: str, options: dict[str, Any]) -> None:
        check.prompt(prompt)
        if not check.model(argparse.Namespace(**self._defaults | options)):
            check.words(prompt)

    def _seeds(self, given: Any, *keys: str) -> tuple[int, ...]:
        whole = isinstance(given, list) and given and all(type(s) is int and 0 <= s < 2**31 for s in given)
        if not whole:
            raise self._problem("These are not seeds.", "Write numbers from 0: seeds = [0, 1].", *keys)
        return tuple(dict.fromkeys(given))

    def _own(self, pattern: str, table: Any, options: dict[str, Any]) -> dict[str, Any]:
        """What a table says for some scenes."""
        keys = ("scene", pattern)
        if not isinstance(table, dict):
            raise self._problem("This is not a table.", f'Write [scene."{pattern}"].', *keys)
        rest = {k: v for k, v in table.items() if k not in ("prompts", "seeds")}
        if "vocabulary" in rest:
            raise self._problem("A scene has no vocabulary of its own.", "Put it under [options].", *keys)
        own = self._options(rest, keys, _OF_SCENE)
        if "prompts" in table:
            own["prompts"] = self._prompts(table["prompts"], options | own, *keys, "prompts")
        if "seeds" in table:
            own["seeds"] = self._seeds(table["seeds"], *keys, "seeds")
        return own

    def _options(self, table: dict[str, Any], keys: tuple[str, ...], more: dict[str, Any]) -> dict[str, Any]:
        """Options of a vibe, each of the type of its default, and good."""
        defaults = {k: v for k, v in self._defaults.items() if k not in _ELSEWHERE} | more
        found: dict[str, Any] = {}
        for key, value in table.items():
            name = key.replace("-", "_")
            if name not in defaults:
                remedy = _ELSEWHERE.get(name, f"Use {', '.join(sorted(defaults))}.")
                raise self._problem(f"Unknown option {key!r}.", remedy, *keys, key)
            default, choices = defaults[name], self._choices.get(name)
            if isinstance(default, list) and isinstance(value, str):
                value = [value]
            kind = int if default is None else type(default)
            if type(value) is not kind or (isinstance(value, list) and not _texts(value)):
                remedy = f"Write it as in {name} = {_example(name, default)}."
                raise self._problem(f"{key} cannot be {value!r}.", remedy, *keys, key)
            if choices and value not in choices:
                raise self._problem(f"{key} cannot be {value!r}.", f"Use {', '.join(choices)}.", *keys, key)
            try:
                self._check_options(self._defaults | {name: value})
            except VibeError as error:
                raise self._problem(error.message, error.remedy, *keys, key) from error
            found[name] = value
        return found

    def _check_options(self, options: dict[str, Any]) -> None:
        given = argparse.Namespace(**options)
        check.numbers(given)
        check.groups(given.groups)
        check.locks(given.lock)
        check.device(given.device)
        if given.vocabulary:
            check.vocabulary(str(self._base / given.vocabulary))

    def _arguments(self, options: dict[str, Any], scene: Path) -> tuple[str, ...]:
        given = argparse.Namespace(**self._defaults | options)
        check.numbers(given)
        arguments = vibe_arguments(given, check.groups(given.groups))
        more = [f"--subject={name}" for name in options.get("subject", ())]
        stage = options.get("stage") if scene.suffix.lower() != ".blend" else ""
        more += [f"--stage={stage}"] if stage else []
        return tuple(a for a in [*arguments, *more] if not a.startswith("--seed="))

    def _limits(self, table: Any) -> Limits:
        known = {f.name: f.default for f in fields(Limits)}
        for key, value in table.items() if isinstance(table, dict) else ():
            if key not in known:
                raise self._problem(f"Unknown limit {key!r}.", f"Use {', '.join(known)}.", "limits", key)
            whole = isinstance(known[key], int)
            if (
                type(value) not in ((int,) if whole else (int, float))
                or value < (key in ("minutes", "cores")) * 0.01
            ):
                remedy = f"Write a {'whole number' if whole else 'number'}, as in {key} = {known[key]}."
                raise self._problem(f"{key} cannot be {value!r}.", remedy, "limits", key)
        return Limits(**self._table({"limits": table}, "limits"))

    def _common(self, options: dict[str, Any]) -> str:
        """Digest of what every result depends on: linked files and the artist's own words."""
        patterns = self._source.content.get("files", [])
        if patterns and not _texts(patterns):
            raise self._problem("These are not files.", 'Write files = ["textures/**"].', "files")
        linked = []
        for pattern in patterns:
            found = sorted(glob.glob(pattern, root_dir=self._base, recursive=True))
            linked += [p for p in found if (self._base / p).is_file()]
            if not found:
                remedy = f"It is looked for from {self._base}."
                raise self._problem(f"No file matches {pattern!r}.", remedy, "files", quoted=pattern)
        if "vocabulary" in options:
            self._file(options["vocabulary"], "vocabulary", "options", "vocabulary")
        words = user_file()
        lines = [f"{p} {_digest(self._base / p)}" for p in linked] + ([_digest(words)] if words else [])
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()

    def _file(self, name: str, what: str, *keys: str) -> Path:
        try:
            return check.file(str(self._base / name), what)
        except VibeError as error:
            raise self._problem(error.message, error.remedy, *keys) from error


def _texts(given: Any) -> bool:
    return isinstance(given, list) and bool(given) and all(isinstance(text, str) for text in given)


def _example(name: str, default: Any) -> str:
    if default is None:
        return str(getattr(budgets.STANDARD, name))
    return {bool: "false", list: '["a", "b"]', str: '"text"'}.get(type(default), str(default))


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
