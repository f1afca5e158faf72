# SPDX-License-Identifier: GPL-3.0-or-later
"""The builds of torch that an engine can have: from where, how large, which one suits this computer, and that in words. No bpy here."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit


@dataclass(frozen=True)
class TorchBuild:
    """One build of torch, and the size of the engine's whole environment with it."""

    key: str
    name: str  # for buttons
    index: str  # address of the package index that has it; "" for the one that pip uses anyway
    download: float  # of all packages, GB
    disk: float  # room that they take, GB


CPU = TorchBuild("CPU", "Processor", "https://download.pytorch.org/whl/cpu", 0.3, 1.1)
CUDA = TorchBuild("CUDA", "NVIDIA Card", "", 2.5, 5.8)
USUAL = TorchBuild("USUAL", "Usual", "", 0.3, 1.1)
"""Of Windows and macOS: the Python Package Index has no CUDA libraries for them."""


def choices() -> tuple[TorchBuild, ...]:
    """The builds that there are for this system."""
    return (CPU, CUDA) if sys.platform == "linux" else (USUAL,)


def suggested() -> TorchBuild:
    """The one that suits this computer."""
    return choices()[-1] if has_nvidia_card() else choices()[0]


def by_key(key: str) -> TorchBuild:
    """The build of a key."""
    return next(build for build in choices() if build.key == key)


def has_nvidia_card(root: Path = Path("/")) -> bool:
    """True if NVIDIA's driver runs a card on this Linux; the open driver runs no CUDA."""
    cards = (root / "proc/driver/nvidia/gpus").glob("*")
    return any(cards) or (root / "usr/lib/wsl/lib/libcuda.so.1").is_file()  # under Windows, its driver's


_INDEX = "the Python Package Index (pypi.org, or the one that your pip uses)"


def download_text(build: TorchBuild, folder: Path) -> list[str]:
    """A description of a build's download: from where, how large it is, where it goes, and whether it suits this computer."""
    source = f"torch from {urlsplit(build.index).netloc}, the rest from" if build.index else "from"
    lines = [
        f"Python packages, {source} {_INDEX}: about {build.download} GB to download, once.",
        f"They take {build.disk} GB in {folder}. Nothing else on this computer changes.",
    ]
    advice = {  # whether a card was found, and the build
        (True, CUDA): "This computer has an NVIDIA card that it can use.",
        (True, CPU): "This computer has an NVIDIA card; this engine would not use it.",
        (False, CPU): "No NVIDIA card was found, and none is needed.",
        (False, CUDA): "No NVIDIA card was found: these are libraries that only such a card can use.",
    }
    return [*lines, advice[has_nvidia_card(), build]] if len(choices()) > 1 else lines
