# SPDX-License-Identifier: Apache-2.0
"""Where torch computes."""

import torch

from ..schema import VibeError


def pick_device(name: str) -> str:
    """The torch device for a name; "auto" is a CUDA card where there is one.

    Raises:
        VibeError: If torch does not have it here.
    """
    if name in ("", "auto"):
        return "cuda" if torch.cuda.is_available() else "cpu"
    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError) as error:
        raise VibeError(
            f"There is no device {name!r} here.", "Use --device cpu, or run `vibe doctor`."
        ) from error
    return name
