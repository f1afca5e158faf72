# SPDX-License-Identifier: Apache-2.0
"""Prefiltered environment: the picture blurred by round lobes, of which the stretched lobes of GGX are composed.

Head on, a GGX lobe of reflected light is round. The flatter a surface is seen, the narrower the lobe becomes across
the plane in which light is reflected, while it stays as long along that plane and leans away from the surface: a lamp
on the horizon draws an upright streak in a floor. A few round lobes one above the other stand for such a lobe, as in
filtered importance sampling (Krivanek and Colbert 2008), here with directions that stay the same.
"""

from __future__ import annotations

import functools
import math

import torch
from torch import Tensor
from torch.nn.functional import interpolate

from ...color.tensors import trilinear
from ..material import albedo
from ..material.microfacets import mirrored, unshadowed, visible_normals

SATIN, GLOSSY = 0.2, 0.4
"""Roughness of the blurred reflections between the mirror image and the diffuse light."""
_FIRST, _STEP, _LEVELS = 0.1, 0.1, 6
"""Roughness of the blurred pictures."""
_HEIGHT = 96
_ROUGH = 0.3
"""Roughness from which lobes are so long that they need more parts."""
_SIDE = 64
_NARROWEST = 0.25
"""Least width of a round lobe relative to the length of what it is a part of: narrower ones would show singly."""


def stack(picture: Tensor) -> Tensor:
    """Blurred pictures (1, 3, L, H, W + 2), wrapped at both sides, of an equirectangular one (1, 3, H, W)."""
    height = min(_HEIGHT, picture.shape[2])
    small = interpolate(picture, (height, 2 * height), mode="area")[0]
    levels = torch.stack([blurred(small, _FIRST + _STEP * level) for level in range(_LEVELS)], 1)
    return torch.cat((levels[..., -1:], levels, levels[..., :1]), -1)[None]


def blurred(picture: Tensor, roughness: float) -> Tensor:
    """A picture (3, H, 2H) averaged over the reflected GGX lobe seen head on (n = v = r).

    The lobe depends on two rows and on the distance between two columns: in a Fourier series along the rows, the
    average is a product.
    """
    height, width = picture.shape[1:]
    elevation = ((torch.arange(height, device=picture.device) + 0.5) / height - 0.5) * math.pi
    apart = torch.arange(width, device=picture.device) * (2 * math.pi / width)
    up, flat = elevation.sin(), elevation.cos()
    cosine = (up[:, None] * up)[..., None] + (flat[:, None] * flat)[..., None] * apart.cos()
    half2 = (1 + cosine) / 2  # squared cosine between the normal and the half vector
    lobe = cosine.clamp_min(0.0) / (half2 * (roughness**4 - 1) + 1) ** 2 * flat[:, None]
    lobe = lobe / lobe.sum((1, 2), keepdim=True)
    waves = torch.fft.rfft(lobe).real.to(torch.complex64)  # even in the distance: no sines
    return torch.fft.irfft(torch.einsum("ijw,cjw->ciw", waves, torch.fft.rfft(picture)), n=width)


def look_up(stack_: Tensor, place: Tensor, roughness: Tensor) -> Tensor:
    """Radiance (3, N).

    Args:
        stack_: What `stack` makes.
        place: (N, 2) in [-1, 1]: across and up the picture.
        roughness: (N,) of the round lobe.
    """
    height, width = stack_.shape[3], stack_.shape[4] - 2
    level = (roughness - _FIRST) / (_STEP * (_LEVELS - 1) / 2) - 1
    x, y = place.unbind(1)
    # `trilinear` counts from the middles of the outermost texels.
    where = torch.stack((x * (width / (width + 1)), y * (height / max(height - 1, 1)), level), 1)
    return trilinear(stack_, where)


@functools.cache
def taps(roughness: float) -> Tensor:
    """The K round lobes that stand for one stretched lobe of a roughness.

    Returns:
        (2, K, 7) coefficients over `albedo.basis` of the viewer's cosine: how far each leans from the mirror
        direction towards the normal (tangent, in sines of the viewer's angle), and its roughness.
    """
    count = 2 if roughness < _ROUGH else 4
    rows = [_taps(c, roughness**2, count) for c in albedo.COSINES]
    return albedo.fit(torch.stack(rows, -1))


def _taps(cosine: float, alpha: float, count: int) -> Tensor:
    """The same for one angle: (2, K)."""
    grid = (torch.arange(_SIDE) + 0.5) / _SIDE
    uv = torch.stack(torch.meshgrid(grid, grid, indexing="ij")).flatten(1)
    viewer = torch.full_like(uv[0], min(cosine, 0.999))
    toward, _ = mirrored(viewer, visible_normals(viewer, alpha, uv))
    weight = unshadowed(viewer, alpha, toward[2])
    sine = (1 - viewer * viewer).sqrt()
    lean = torch.atan2(viewer * toward[0] + sine * toward[2], viewer * toward[2] - sine * toward[0])
    order = lean.argsort()
    lean, weight, aside = lean[order], weight[order], toward[1].abs().asin()[order]
    # As many parts as there are round lobes, one above the other, each with the same light.
    part = ((weight.cumsum(0) - weight / 2) * (count / weight.sum())).long().clamp_max(count - 1)
    parts = [part == k for k in range(count)]
    middle = torch.stack([(lean[p] * weight[p]).sum() / weight[p].sum() for p in parts])
    width = torch.stack([_median(aside[p], weight[p]) for p in parts])
    length = _median((lean - _median(lean, weight)).abs(), weight)
    width = torch.maximum(width, _NARROWEST * length)
    # Each is as long as it is wide: they lie closer together than the parts do.
    center = middle.mean()
    middle = center + (middle - center) * (1 - (width.mean() / length) ** 2).clamp_min(0.0).sqrt()
    # Half of a GGX lobe of slopes lies within alpha / sqrt(3) of a line through its middle.
    round_ = (math.sqrt(3) * (width / 2).tan()).sqrt()
    return torch.stack((middle.clamp_max(1.4).tan() / sine[0], round_))


def _median(values: Tensor, weights: Tensor) -> Tensor:
    """Median () of values (N,) with weights (N,)."""
    order = values.argsort()
    below = weights[order].cumsum(0)
    return values[order][torch.searchsorted(below, below[-1] / 2).clamp_max(len(values) - 1)]
