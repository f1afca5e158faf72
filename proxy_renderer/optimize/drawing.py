# SPDX-License-Identifier: Apache-2.0
"""From the vector u to a picture of the proxy: I = R(θ), equation 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch
from torch import Tensor

from ..guidance.encoder import Encoder
from ..scene import SceneData
from ..schema.messages import Options
from .vector import ParameterVector

if TYPE_CHECKING:
    from ..render.proxy import Proxy, Render

_LARGEST, _LEAST = 256, 192
"""Greatest longer side of the pictures inside the loop, in pixels, and the least however small the encoder's are."""
_OF_A_PICTURE = 128  # the same where a picture says what is wanted: nothing so fine is read off it


def draw(
    proxy: Proxy, vector: ParameterVector, u: Tensor, free: set[str] | frozenset[str] = frozenset()
) -> Render:
    """Renders u (N,): values that are the artist's own are left to the scene, exactly as they are.

    Args:
        vector: The parameters of u.
        u: (N,) the point.
    """
    return proxy.render(chosen_values(vector, u, proxy.device, free))


def chosen_values(
    vector: ParameterVector,
    u: Tensor,
    device: torch.device,
    free: set[str] | frozenset[str] = frozenset(),
) -> dict[str, Tensor]:
    """The values of u (N,) that are free, with gradients, or no longer the artist's.

    Args:
        vector: The parameters of u.
        u: (N,) the point.
        device: Where the values are to be.

    Returns:
        Key -> (components,) float32 in schema units.
    """
    moved = (u.detach() - vector.encode({})).abs() > 1e-9
    values = {}
    for key, value in vector.decode(u).items():
        if key in free:
            values[key] = value.to(device)
        elif key in vector.taken or moved[vector.slices[key]].any():
            values[key] = value.detach().to(device)
    return values


def picture_size(resolution: tuple[int, int], longest: int) -> tuple[int, int]:
    """Width and height of the artist's picture, scaled so that the longer side has this many pixels.

    Args:
        resolution: The artist's width and height, pixels.
        longest: Of the result's sides, pixels.
    """
    factor = longest / max(resolution)
    width, height = (max(round(n * factor), 1) for n in resolution)
    return width, height


def inner_size(scene: SceneData, options: Options, encoder: Encoder) -> tuple[int, int]:
    """Width and height of the pictures inside the loop; the prediction has the full size.

    Crops are at least three quarters of the picture, so one and a half times what the encoder looks at is enough;
    but highlights and shadows have to be there, however little it looks at.

    Args:
        options: `size` is the most that the artist wants.
        encoder: `size` is what it looks at.
    """
    enough = max(_LEAST, encoder.size * 3 // 2) if not options.like else _OF_A_PICTURE
    return picture_size(scene.resolution, min(options.size, _LARGEST, enough))
