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
    """All that are kept; none where the file cannot be read."""
    try:
        stored = json.loads((own_folder("") / _NAME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    return [text for text in stored if isinstance(text, str)] if isinstance(stored, list) else []


def remember(prompt: str) -> None:
    """Puts a prompt first. A folder that cannot be written keeps none, which is no reason to fail."""
    kept = [prompt, *(text for text in prompts() if text != prompt)][:_MOST]
    with contextlib.suppress(OSError, schema.VibeError), whole(own_folder("", create=True) / _NAME) as part:
        part.write_text(json.dumps(kept, ensure_ascii=False, indent=1), encoding="utf-8")


def clear() -> None:
    """Forgets all."""
    with contextlib.suppress(OSError):
        (own_folder("") / _NAME).unlink(missing_ok=True)
