# SPDX-License-Identifier: Apache-2.0
"""From the vector u to a picture of the proxy: I = R(θ), equation 1."""

from __future__ import annotations

from typing import TYPE_CHECKING

import torch
from torch import Tensor

from .vector import ParameterVector

if TYPE_CHECKING:
    from ..render.proxy import Proxy, Render


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
