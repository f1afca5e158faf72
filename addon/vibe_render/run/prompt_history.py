# SPDX-License-Identifier: GPL-3.0-or-later
"""The prompts that were typed, with what their words describe, the newest first: a small file of the user's, for all scenes."""

from __future__ import annotations

import contextlib
import json
from collections.abc import Sequence
from typing import Any

from ..core.files import whole
from ..core.preferences import own_folder
from ..core.schema_import import schema

_MOST = 30  # prompts that are kept
_NAME = "prompts.json"


def prompts() -> list[str]:
    """The stored prompts, the newest first; none where the file cannot be read."""
    return [text for text, _ in _stored()]


def targets_of(prompt: str) -> list[str]:
    """What the artist said that words of a stored prompt describe: "copper=Cup"."""
    return next((targets for text, targets in _stored() if text == prompt), [])


def remember(prompt: str, targets: Sequence[str] = ()) -> None:
    """Puts a prompt first, and drops the oldest. Where the folder cannot be written, nothing is stored and nothing fails.

    Args:
        targets: What the artist says that its words describe.
    """
    kept = [(prompt, [*targets]), *(each for each in _stored() if each[0] != prompt)][:_MOST]
    rows = [{"prompt": text, "targets": told} if told else text for text, told in kept]
    with contextlib.suppress(OSError, schema.VibeError), whole(own_folder("", create=True) / _NAME) as part:
        part.write_text(json.dumps(rows, ensure_ascii=False, indent=1), encoding="utf-8")


def _stored() -> list[tuple[str, list[str]]]:
    """The prompts with their targets."""
    try:
        stored = json.loads((own_folder("") / _NAME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    rows = (
        [{"prompt": row} if isinstance(row, str) else row for row in stored if isinstance(row, str | dict)]
        if isinstance(stored, list)
        else []
    )
    return [(row["prompt"], _texts(row.get("targets"))) for row in rows if isinstance(row.get("prompt"), str)]


def _texts(value: Any) -> list[str]:
    """The pairs of word and target in a value of a file that anybody may have written."""
    return (
        [text for text in value if isinstance(text, str) and "=" in text.strip("= ")]
        if isinstance(value, list)
        else []
    )


def clear() -> None:
    """Deletes the history."""
    with contextlib.suppress(OSError):
        (own_folder("") / _NAME).unlink(missing_ok=True)
