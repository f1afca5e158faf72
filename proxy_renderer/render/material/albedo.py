# SPDX-License-Identifier: Apache-2.0
"""GGX microfacets, and directional albedos of their reflection as short sums over fixed functions of the cosine.

Energy compensation and layering need functions of (cosine, roughness, IOR). Roughness and IOR belong to a material, the
cosine to a sample. Written as coefficients(roughness, IOR) @ basis(cosine), a function costs one small dot product per
sample. Coefficients are fitted once to integrals over visible microfacets (Heitz, "Sampling the GGX Distribution of
Visible Normals", 2018). Vectors are in the surface's frame: z is its normal, and the viewer is in the x-z plane.
"""

import functools
import math

import torch
from jaxtyping import Float
from torch import Tensor

_POWERS = (0, 1, 2, 3, 5, 8, 14)  # powers of (1 - cosine) that make the basis
SCHLICK_CURVE = tuple(float(p == 5) for p in _POWERS)  # coefficients of (1 - c)^5
_ROUGHNESS, _CONTRAST = 17, 17  # numbers of roughness and IOR values in tables
_SIDE = 12  # its square is the number of microfacet normals per integral
COSINES = tuple((torch.linspace(0.0, 1.0, 24) ** 1.25 * 0.99 + 0.01).tolist())
"""Cosines at which `fit` takes the values of functions; denser at grazing angles, where albedos change fastest."""


def basis(cosine: Float[Tensor, " n"]) -> Float[Tensor, "7 n"]:
    """The powers `_POWERS` of 1 - cosine (N,): (7, N)."""
    x = (1 - cosine).clamp(0.0, 1.0)
    x2 = x * x
    x3 = x2 * x
    x5 = x3 * x2
    x8 = x5 * x3
    return torch.stack((torch.ones_like(x), x, x2, x3, x5, x8, x8 * x5 * x))


def fresnel(cosine: Tensor, ior: Tensor | float) -> Tensor:
    """Unpolarized reflectance of a dielectric (IOR at least 1) at the incident cosine."""
    c = cosine.abs()
    g = (ior * ior - 1 + c * c).sqrt()
    a = (g - c) / (g + c)
    b = (c * (g + c) - 1) / (c * (g - c) + 1)
    return 0.5 * a * a * (1 + b * b)


def f0_of(ior: Tensor) -> Tensor:
    """Reflectance of a dielectric of some IOR, seen head on."""
    return ((ior - 1) / (ior + 1)) ** 2


def over_roughness(name: str, roughness: Tensor) -> Tensor:
    """Coefficients (7,) of a table of `_tables`, or "mean" (), at a roughness (); (7, N) or (N,) at roughness (N,)."""
    return _between(_tables()[name], roughness)


def over_ior(name: str, ior: Tensor) -> Tensor:
    """Coefficients at an IOR () of a table of `_tables`: (7,) of "curve", (R, 7) of "dielectric"."""
    return _between(_tables()[name], ((ior - 1) / (ior + 1)).clamp_min(1e-4).sqrt())


def dielectric_share(roughness: Tensor, ior: Tensor) -> Tensor:
    """Coefficients of the table "dielectric" of `_tables`: (7,) at a roughness (), (7, N) at a roughness (N,)."""
    return _between(over_ior("dielectric", ior), roughness)


@functools.cache
def edge_curve() -> Tensor:
    """Coefficients (7,) of c (1 - c)^6, by which the F82 model tints a metal's edge."""
    cosine = torch.tensor(COSINES)
    return fit(cosine * (1 - cosine) ** 6)


def weigh(coefficients: Tensor, basis_: Tensor) -> Tensor:
    """Values (N,) of a function with coefficients (7,), or (7, N) where they vary, at the basis (7, N)."""
    if coefficients.dim() == 1:
        return coefficients @ basis_
    return (coefficients * basis_).sum(0)


def _between(table: Tensor, place: Tensor) -> Tensor:
    """Catmull-Rom interpolation in a table (R, ...) over [0, 1]: (...) at a place (), (..., N) at places (N,)."""
    last = len(table) - 1
    x = place.clamp(0.0, 1.0) * last
    if place.dim():
        near = x.detach().clamp(0, last - 1).long()
        rows = [table.to(place.device)[(near + k).clamp(0, last)].movedim(0, -1) for k in (-1, 0, 1, 2)]
        t = x - near
    else:
        i = int(x.detach().clamp(0, last - 1))
        rows = [table[min(max(i + k, 0), last)].to(place.device) for k in (-1, 0, 1, 2)]
        t = x - i
    p0, p1, p2, p3 = rows
    return p1 + 0.5 * t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0)))


def fit(values: Tensor) -> Tensor:
    """Least-squares coefficients (..., 7) of functions given at `COSINES` (..., 24)."""
    return (torch.linalg.pinv(basis(torch.tensor(COSINES)).T.double()) @ values.double()[..., None])[..., 0].float()


@functools.cache
def _tables() -> dict[str, Tensor]:
    """Tables of coefficients over R values of roughness and Z values of the IOR.

    energy (R, 7): the single-scattering albedo without Fresnel; mean (R,): its cosine-weighted mean, not coefficients
    schlick (R, 7): s in albedo = energy * mix(F0, 1, s), with Schlick's fifth power as Fresnel curve
    edge (R, 7): the albedo of F82's edge term c (1 - c)^6, divided by the albedo without Fresnel
    dielectric (Z, R, 7): s for a dielectric's true Fresnel curve
    curve (Z, 7): that curve itself, (F - F0) / (1 - F0), over the cosine at the half vector
    """
    roughness, cosine = torch.linspace(0, 1, _ROUGHNESS).clamp_min(0.02), torch.tensor(COSINES)
    # Weights G2/G1 and half-vector cosines (R, C, S), for C cosines of the viewer and S visible microfacets.
    grid = (torch.arange(_SIDE) + 0.5) / _SIDE
    uv = torch.stack(torch.meshgrid(grid, grid, indexing="ij")).flatten(1)
    alpha, viewer = (roughness * roughness)[:, None, None], cosine[None, :, None]
    toward, at_half = mirrored(viewer, visible_normals(viewer, alpha, uv[:, None, None]))
    weight = unshadowed(viewer, alpha, toward[2])
    e = weight.mean(-1)
    schlick = ((1 - at_half) ** 5 * weight).mean(-1) / e
    fine = torch.linspace(0, 1, 257)[1:] - 1 / 512
    edge = (at_half * (1 - at_half) ** 6 * weight).mean(-1) / e
    energy = fit(e)
    mean = (energy @ basis(fine) * (2 * fine)).mean(-1)
    contrast = torch.linspace(0, 1, _CONTRAST).clamp(0.01, 0.99) ** 2
    shares, curves = [], []
    for ior in (1 + contrast) / (1 - contrast):
        f0 = f0_of(ior)
        share = (((fresnel(at_half, ior) - f0) / (1 - f0)) * weight).mean(-1) / e
        shares.append(fit(share))
        curves.append(fit((fresnel(cosine, ior) - f0) / (1 - f0)))
    tables = {"energy": energy, "mean": mean, "schlick": fit(schlick), "edge": fit(edge)}
    return {**tables, "dielectric": torch.stack(shares), "curve": torch.stack(curves)}


def visible_normals(cosine: Tensor, alpha: Tensor | float, uv: Tensor) -> Tensor:
    """Unit normals (3, ...) of microfacets, distributed as a viewer sees them, from `uv` (2, ...) in [0, 1).

    `cosine` (...) is that of the angle between viewer and surface normal, above 0; `alpha` is the roughness squared.
    """
    sine = (1 - cosine * cosine).clamp_min(0.0).sqrt()
    length = ((alpha * sine) ** 2 + cosine * cosine).sqrt()
    x, z = alpha * sine / length, cosine / length
    radius, angle = uv[0].sqrt(), 2 * math.pi * uv[1]
    t1, t2 = radius * angle.cos(), radius * angle.sin()
    t2 = (1 - (1 + z) / 2) * (1 - t1 * t1).clamp_min(0.0).sqrt() + (1 + z) / 2 * t2
    t3 = (1 - t1 * t1 - t2 * t2).clamp_min(0.0).sqrt()
    # Axes around the stretched view: (0, 1, 0), (-z, 0, x), and the view (x, 0, z) itself.
    sides = alpha * (t3 * x - t2 * z), alpha * t1, (t3 * z + t2 * x).clamp_min(1e-6)
    normal = torch.stack(torch.broadcast_tensors(*sides))
    return normal / normal.square().sum(0).sqrt()


def mirrored(cosine: Tensor, normal: Tensor) -> tuple[Tensor, Tensor]:
    """Directions (3, ...) to which microfacets with normals (3, ...) reflect the viewer's ray.

    `cosine` (...): of viewer to surface normal. Also returns the cosine (...) of viewer to microfacet normals.
    """
    sine = (1 - cosine * cosine).clamp_min(0.0).sqrt()
    at_half = (sine * normal[0] + cosine * normal[2]).clamp(0.0, 1.0)
    x, y, z = 2 * at_half * normal
    return torch.stack((x - sine, y, z - cosine)), at_half


def unshadowed(cosine: Tensor, alpha: Tensor | float, leaving: Tensor) -> Tensor:
    """Share (...) of reflected light that no other microfacet blocks, G2/G1; 0 below the surface.

    `cosine` and `leaving` (...): of viewer and reflected light to the surface normal. `alpha` is the roughness squared.
    """
    masking = (1 + alpha**2 * (1 / (cosine * cosine) - 1)).sqrt()
    shadowing = (1 + alpha**2 * (1 / leaving.clamp(1e-4, 1.0) ** 2 - 1)).sqrt()
    return torch.where(leaving > 0, (1 + masking) / (masking + shadowing), 0.0)
