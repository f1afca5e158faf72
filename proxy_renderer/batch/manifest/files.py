# SPDX-License-Identifier: Apache-2.0
"""The files that a manifest names, and digests of what is in them."""

from __future__ import annotations

import glob
import hashlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from ...inputs import check
from ...schema import VibeError
from ...words.lexicon.user_words import user_file
from .options import texts
from .toml_source import TomlSource


class Files:
    """Finds files from the manifest's folder.

    Args:
        out: The results folder, which holds no scenes.

    Attributes:
        base: The manifest's folder.
    """

    def __init__(self, source: TomlSource, out: Path) -> None:
        self.base = source.path.parent.resolve()
        self._problem, self._out = source.problem, out

    def scenes(self, patterns: Any, *keys: str) -> Iterator[tuple[str, Path]]:
        """The scenes that patterns name, in the order of the manifest.

        Args:
            patterns: A list of paths and globs, from the manifest's folder.
            *keys: Where they stand in the manifest, for the error's line number.

        Yields:
            A scene's name in the results, and its path.

        Raises:
            VibeError: There are none, a pattern matches nothing, or a file is not a scene.
        """
        if not texts(patterns):
            raise self._problem("There are no scenes.", 'Write scenes = ["shots/*.blend"].', *keys)
        for pattern in patterns:
            places = sorted(glob.glob(pattern, root_dir=self.base, recursive=True))
            if glob.has_magic(pattern):
                places = [p for p in places if Path(p).suffix.lower() in check.SCENES]
            places = [p for p in places if not (self.base / p).resolve().is_relative_to(self._out)]
            if not places:
                remedy = f"It is looked for from {self.base}; scenes are {' '.join(check.SCENES)} files."
                raise self._problem(f"No scene matches {pattern!r}.", remedy, *keys, quoted=pattern)
            for place in places:
                try:
                    scene = check.scene(str(self.base / place))
                except VibeError as error:
                    raise self._problem(error.message, error.remedy, *keys, quoted=pattern) from error
                yield Path(os.path.relpath(self.base / place, self.base)).as_posix(), scene

    def common(self, patterns: Any, vocabulary: str) -> str:
        """Digest of what every result depends on: linked files and the artist's own words.

        Args:
            patterns: `files` of the manifest: glob patterns relative to its folder.
            vocabulary: The option of that name; "" for none.

        Returns:
            SHA-256 in hexadecimal, 64 characters.

        Raises:
            VibeError: The patterns are no texts, or one of them matches no file; names the line.
        """
        if patterns and not texts(patterns):
            raise self._problem("These are not files.", 'Write files = ["textures/**"].', "files")
        linked = []
        for pattern in patterns:
            matches = sorted(glob.glob(pattern, root_dir=self.base, recursive=True))
            linked += [p for p in matches if (self.base / p).is_file()]
            if not matches:
                remedy = f"It is looked for from {self.base}."
                raise self._problem(f"No file matches {pattern!r}.", remedy, "files", quoted=pattern)
        if vocabulary:
            self.named(vocabulary, "vocabulary", "options", "vocabulary")
        words = user_file()
        lines = [f"{p} {digest(self.base / p)}" for p in linked] + ([digest(words)] if words else [])
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()

    def named(self, name: str, what: str, *keys: str) -> Path:
        """The path of a file that the manifest names, once it is known to be readable.

        Args:
            name: As written, relative to the manifest's folder.
            what: The kind of file, for the error: "scene".
            keys: Where the manifest names it, for the error's line.

        Raises:
            VibeError: There is no such file, or it cannot be read; names the line.
        """
        try:
            return check.file(str(self.base / name), what)
        except VibeError as error:
            raise self._problem(error.message, error.remedy, *keys) from error


def digest(path: Path) -> str:
    """Of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
