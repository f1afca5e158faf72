# SPDX-License-Identifier: GPL-3.0-or-later
"""The prompts that were typed, the newest first: a small file of the user's, for all scenes."""

from __future__ import annotations

import contextlib
import json

from ..core.files import whole
from ..core.schema_import import schema
from ..core.user_folder import own_folder

_MOST = 30  # prompts that are kept
_NAME = "prompts.json"


def prompts() -> list[str]:
    """The stored prompts, the newest first; none where the file cannot be read."""
    try:
        stored = json.loads((own_folder("") / _NAME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    return [text for text in stored if isinstance(text, str)] if isinstance(stored, list) else []


def remember(prompt: str) -> None:
    """Puts a prompt first, and drops the oldest. Where the folder cannot be written, nothing is stored and nothing fails."""
    kept = [prompt, *(text for text in prompts() if text != prompt)][:_MOST]
    with contextlib.suppress(OSError, schema.VibeError), whole(own_folder("", create=True) / _NAME) as part:
        part.write_text(json.dumps(kept, ensure_ascii=False, indent=1), encoding="utf-8")


def clear() -> None:
    """Deletes the history."""
    with contextlib.suppress(OSError):
        (own_folder("") / _NAME).unlink(missing_ok=True)
