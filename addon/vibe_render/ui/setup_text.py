# SPDX-License-Identifier: GPL-3.0-or-later
"""What Set Up Engine downloads, in words, before it does. No bpy here."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import urlsplit

from ..engine import torch_builds

_INDEX = "the Python Package Index (pypi.org, or the one that your pip uses)"


def lines(build: torch_builds.TorchBuild, folder: Path) -> list[str]:
    """What a build downloads, from where, how large it is, where it goes, and whether it suits this computer."""
    source = (
        f"torch from {urlsplit(build.index).netloc}, the rest from {_INDEX}"
        if build.index
        else f"from {_INDEX}"
    )
    said = [
        f"Python packages, {source}: about {build.download} GB to download, once.",
        f"They take {build.disk} GB in {folder}. Nothing else on this computer changes.",
    ]
    if len(torch_builds.choices()) > 1:
        said.append(_advice(build))
    return said


def _advice(build: torch_builds.TorchBuild) -> str:
    if torch_builds.has_nvidia_card():
        return (
            "This computer has an NVIDIA card that it can use."
            if build is torch_builds.CUDA
            else ("This computer has an NVIDIA card; this engine would not use it.")
        )
    return (
        "No NVIDIA card was found, and none is needed."
        if build is torch_builds.CPU
        else ("No NVIDIA card was found: these are libraries that only such a card can use.")
    )
