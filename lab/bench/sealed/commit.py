# SPDX-License-Identifier: Apache-2.0
"""The judged commit, whose hash is the seed of what is drawn."""

from __future__ import annotations

import subprocess
from pathlib import Path

import proxy_renderer
from proxy_renderer.schema import VibeError


def judged_commit(root: Path | None = None) -> tuple[str, bool]:
    """The hash of the commit that a clone is at, and whether files of it have been changed since.

    Args:
        root: Of the clone; None for the one that this package lies in.

    Raises:
        VibeError: It is no clone.
    """
    root = root or Path(proxy_renderer.__file__).resolve().parents[1]
    if not (root / ".git").exists():
        raise VibeError(
            "This Vibe Render is no clone, so there is no commit to draw from.",
            "Name a seed: --seed TEXT, or run it in a clone.",
        )
    return _git(root, "rev-parse", "HEAD"), bool(_git(root, "status", "--porcelain"))


def _git(root: Path, *arguments: str) -> str:
    try:
        done = subprocess.run(
            ["git", "-C", str(root), *arguments], capture_output=True, text=True, check=True, timeout=60
        )
    except (OSError, subprocess.SubprocessError) as error:
        raise VibeError("git does not say which commit this is.", "Name a seed: --seed TEXT.") from error
    return done.stdout.strip()
