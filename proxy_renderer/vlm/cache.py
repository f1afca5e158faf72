# SPDX-License-Identifier: Apache-2.0
"""Answers on disk, by the content of their question: the same question is paid for once."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from pathlib import Path
from typing import Any

from ..folders import cache_folder
from ..schema import atomic

_MOST = 500  # answers that are kept; the ones used longest ago go first


class Cache:
    """One small JSON file for each answer. A file that cannot be read or written counts as missing.

    Args:
        folder: Made when needed; None for the user's cache folder.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder or cache_folder("vlm")

    @staticmethod
    def key(*parts: Any) -> str:
        """A name for content: JSON values and bytes."""
        digest = hashlib.sha256()
        for part in parts:
            raw = part if isinstance(part, bytes) else json.dumps(part, sort_keys=True).encode()
            digest.update(len(raw).to_bytes(8, "big") + raw)
        return digest.hexdigest()

    def read(self, key: str) -> Any:
        """An answer, or None."""
        path = self.folder / f"{key}.json"
        try:
            answer = json.loads(path.read_text(encoding="utf-8"))["answer"]
            os.utime(path)
            return answer
        except (OSError, ValueError, KeyError, TypeError, RecursionError):
            return None

    def write(self, key: str, answer: Any) -> None:
        """Keeps an answer, all at once or not at all, readable by its owner only.

        A disk that cannot be written is no error: the question is then paid for again.

        Args:
            key: Of the question, as `key` returns it.
        """
        with contextlib.suppress(OSError, RuntimeError):
            self.folder.mkdir(parents=True, exist_ok=True)
            with atomic.replacing(self.folder / f"{key}.json") as part:
                part.touch(mode=0o600)
                part.write_text(json.dumps({"answer": answer}), encoding="utf-8")
            self._prune()

    def _prune(self) -> None:
        files = sorted(self.folder.glob("*.json"), key=lambda p: p.stat().st_mtime)
        for path in files[:-_MOST]:
            path.unlink(missing_ok=True)
