# SPDX-License-Identifier: Apache-2.0
"""Cache of rendered references between measurements."""

from __future__ import annotations

from pathlib import Path

from proxy_renderer.folders import cache_folder


def folder(chosen: str = "") -> Path:
    """The folder chosen, else the user's for reference pictures."""
    return Path(chosen).expanduser().resolve() if chosen else cache_folder("fidelity")
