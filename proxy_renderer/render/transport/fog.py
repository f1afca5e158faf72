# SPDX-License-Identifier: Apache-2.0
"""Fog: a participating medium with analytic transmittance, and its single scattering as the camera sees it.

Extinction σ(x) = density · exp(−falloff · max(0, z − base − offset)), gray, inside an axis-aligned box or everywhere.

The rays of a coarse image are cut into segments. In each, a light's irradiance is averaged analytically, so that its glow needs
no dense samples, and the scattered share is exact: the transmittance lost in the segment. The running sums are kept on a grid
over image and depth (froxels), which samples look up by their own depth: fog in front of a near subject does not mix with fog in
front of the background. Cycles, too, scatters once with its default of no volume bounces.
"""

import math
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass, field

import torch
from jaxtyping import Float
from torch import Tensor
from torch.nn import functional

from ...color.tensors import trilinear
from ...scene import SceneData
from ...scene.values import Recent, RenderValues, needs_gradient
from ..geometry.camera import RaySegments, View
from ..geometry.vectors import length
from ..lights.light_source import LightSource

_Vectors = Float[Tensor, "3 *#n"]
_Numbers = Float[Tensor, "*#n"]

_EVERYWHERE = 1.0e3  # diameter of an infinite fog in diagonals of the box: fog farther away is ignored
SEGMENTS = 16
COARSE = 8  # pixels per ray of the coarse image, along each axis
_BULK = 3.0  # distance up to which segments are fine, in distances of the subject or of the farthest light
_WORLD_COARSE = 4  # rays of the coarse image per ray of the world's light, along each axis


class FogMedium:
    """The scene's fog with one set of values."""

    def __init__(self, scene: SceneData, settings: RenderValues) -> None:
        spec = scene.volume
        self.density = settings.scalar("volume/density")  # () 1/m, below the height where the fog thins
        self.albedo = settings.color("volume/color", 0.8)  # (3,) share of the extinguished light that is scattered
        self.anisotropy = settings.scalar("volume/anisotropy")  # () Henyey-Greenstein g
        self._falloff = settings.scalar("volume/falloff")
        self._top = spec.base + settings.scalar("volume/offset")
        self._thins = self._falloff.requires_grad or bool(self._falloff > 0)
        center, half = (torch.tensor(v, device=settings.device) for v in (spec.center, spec.half_size))
        self._box = None if spec.kind == "world" else (center - half, center + half)
        self.extent = float(2 * half.norm()) * (1 if self._box else _EVERYWHERE)  # meters; crosses all of the fog

    @property
    def active(self) -> bool:
        """True if there is fog, or its density is being learned."""
        return self.density.requires_grad or bool(self.density > 0)

    @property
    def shape(self) -> tuple[float, ...] | None:
        """Numbers that `thickness` depends on; None while they need gradients."""
        if not self._thins:
            return ()
        return None if needs_gradient(self._falloff, self._top) else (float(self._falloff), float(self._top))

    @property
    def signature(self) -> tuple[float, ...] | None:
        """Numbers that transmittance and phase depend on; None while they need gradients."""
        if self.shape is None or needs_gradient(self.density, self.anisotropy):
            return None
        return float(self.density), float(self.anisotropy), *self.shape

    def reach(self, origin: Tensor) -> float:
        """Distance in meters from `origin` (3,) beyond which fog is ignored."""
        if self._box is None:
            return self.extent
        low, high = self._box
        return float(torch.maximum((origin - low).abs(), (origin - high).abs()).norm())

    def transmittance(self, start: _Vectors, toward: _Vectors, distance: _Numbers | float) -> Float[Tensor, "*n"]:
        """Share of light (…) that gets through, from starts (3, …) in unit directions (3, …) over distances (…), finite or not."""
        return torch.exp(-self.density * self.thickness(start, toward, distance))

    def thickness(self, start: _Vectors, toward: _Vectors, distance: _Numbers | float) -> Float[Tensor, "*n"]:
        """Optical depth divided by density, in meters (…); arguments as for `transmittance`."""
        first, last = self._inside(start, toward, distance)
        length = last - first
        if not self._thins:
            return length
        # The mean of exp(−falloff · max(0, h)) for heights h from a to b.
        height = start[2] - self._top
        a, b = height + toward[2] * first, height + toward[2] * last
        rise = b - a
        level = rise.abs() <= 1e-3 * (a.abs() + b.abs())
        slope = (self._below(b) - self._below(a)) / torch.where(level, 1.0, rise)
        return length * torch.where(level, torch.exp(-self._falloff * ((a + b) / 2).clamp_min(0)), slope)

    def _inside(self, start: Tensor, toward: Tensor, distance: Tensor | float) -> tuple[Tensor, Tensor]:
        """Distances (…) in meters at which rays enter and leave the fog, first ≤ last; equal for rays outside of it."""
        limit = torch.as_tensor(distance, dtype=start.dtype, device=start.device)
        limit = torch.broadcast_tensors(limit, start[0], toward[0])[0]
        if self._box is None:
            return torch.zeros_like(limit), limit.clamp_max(self.extent)
        near, far = torch.zeros_like(limit), limit
        for axis in range(3):
            slope = torch.where(toward[axis].abs() < 1e-9, 1e-9, toward[axis])
            one, two = ((side[axis] - start[axis]) / slope for side in self._box)
            near = torch.maximum(near, torch.minimum(one, two))
            far = torch.minimum(far, torch.maximum(one, two))
        far = far.clamp_min(0)
        return torch.minimum(near, far), far

    def _below(self, height: Tensor) -> Tensor:
        """∫ exp(−falloff · max(0, h)) dh up to `height`, from the height where the fog starts to thin."""
        x = self._falloff * height.clamp_min(0)
        thin = x < 1e-3
        safe = torch.where(thin, 1.0, x)
        share = torch.where(thin, 1 - x / 2, -torch.expm1(-safe) / safe)
        return torch.where(height > 0, height * share, height)


@dataclass(frozen=True)
class LightPaths:
    """Segments through one scene's fog, as `FogMedium.transmittance` takes them; their thickness is cached."""

    start: _Vectors
    toward: _Vectors
    distance: _Numbers
    _measured: Recent = field(default_factory=Recent, init=False, repr=False, compare=False)

    def transmittance(self, fog: FogMedium) -> Float[Tensor, "*n"]:
        """Share of light (…) that gets through."""
        way = self.start, self.toward, self.distance
        if fog.shape is None or needs_gradient(*way):
            return fog.transmittance(*way)
        return torch.exp(-fog.density * self._measured.of("", fog.shape, lambda: fog.thickness(*way)))


def _lebedev() -> Tensor:
    """Lebedev's 14 directions, turned so that their heights are evenly spread: none lies along a floor."""
    d = 3**-0.5
    corners = [[x, y, z] for x in (d, -d) for y in (d, -d) for z in (d, -d)]
    axes = torch.cat((torch.eye(3), -torch.eye(3), torch.tensor(corners))).T
    (c, s), (e, f) = ((math.cos(math.radians(a)), math.sin(math.radians(a))) for a in (21, 15))
    around_z = torch.tensor([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    around_x = torch.tensor([[1, 0, 0], [0, e, -f], [0, f, e]])
    return around_x @ around_z @ axes


DIRECTIONS = _lebedev()  # (3, 14) unit vectors for the world's light; exact to the fifth degree
WEIGHTS = torch.tensor([1 / 15] * 6 + [3 / 40] * 8)


@dataclass(frozen=True)
class FroxelGrid:
    """In-scattered light and optical depth between the camera and any point, on a grid over image and depth."""

    _sums: Tensor  # (1, 4, SEGMENTS + 1, rows, columns): scattered light, and optical depth
    _size: tuple[int, int]  # width and height of the image, pixels
    _near: float  # meters: cut k is at near · (growth^k − 1)
    _growth: float
    _bulk: float  # meters up to which the cuts' distances grow; one more cut is at `_end`
    _end: float

    def look_up(self, place: Tensor, distance: Tensor) -> tuple[Tensor, Tensor]:
        """Light (3, N) of the fog in front of places (2, N), pixels, at distances (N,), and its transmittance (N,)."""
        segments, rows, columns = self._sums.shape[2] - 1, *self._sums.shape[3:]
        cut = (torch.log1p(distance / self._near) / math.log(self._growth)).clamp(0, segments - 1)
        whole = cut.detach().floor().clamp_max(segments - 2)
        # Linear in meters between cuts.
        cut = whole + (self._growth ** (cut - whole) - 1) / (self._growth - 1)
        cut = cut + ((distance - self._bulk) / (self._end - self._bulk)).clamp(0, 1)
        # grid_sample's corners are the centers of the outer cells
        sides = zip(place, (columns, rows), self._size, strict=True)
        cells = [(p * (n / size) - 0.5) * (2 / max(n - 1, 1)) - 1 for p, n, size in sides]
        sums = trilinear(self._sums, torch.stack((*cells, cut * (2 / segments) - 1), -1))
        return sums[:3], torch.exp(-sums[3])


class SingleScattering:
    """Single scattering in the fog of one scene; shadows, traced by `RayGeometry.clear`, are kept until rays change."""

    def __init__(self, clear: Callable[..., Tensor]) -> None:
        self._clear = clear
        self._shadows, self._strengths = Recent(), Recent()

    def scatter(self, fog: FogMedium, view: View, near: float, lamps: list[LightSource], world: Tensor) -> FroxelGrid:
        """The fog in front of a camera: its scattered light and optical depth.

        `near` is a typical viewing distance in meters, `world` (3, 14) or (3, 1) the world's radiance by direction.
        """
        eye = view.position.detach()
        away = [length(lamp.position.detach() - eye, 0.0) for lamp in lamps if not lamp.at_infinity]
        end = fog.reach(eye)
        bulk = min(0.9 * end, _BULK * max([near, *map(float, away)]))
        growth = (1 + bulk / near) ** (1 / (SEGMENTS - 1))
        cuts = near * (growth ** torch.arange(SEGMENTS + 1, device=eye.device) - 1).view(-1, 1, 1)
        cuts[-1] = end
        rays = RaySegments.of(view, COARSE, cuts)
        depth = fog.density * fog.thickness(rays.start[:, None], rays.toward[:, None], cuts)
        passing = torch.exp(-depth)  # (SEGMENTS + 1, rows, columns)
        wide = RaySegments.of(view, COARSE * _WORLD_COARSE, cuts)
        arriving = self._of(fog, wide, "", "world", lambda: self._world_arriving(fog, wide))
        light = torch.einsum("cd,dsxy->csxy", world.expand(3, len(WEIGHTS)), arriving)
        light = functional.interpolate(light, size=passing.shape[1:], mode="bilinear")
        for lamp in (lamp for lamp in lamps if lamp.shines):
            light = light + self.lamp_light(fog, rays, lamp, lamp.segment_parts)
        scattered = (light * fog.albedo.view(3, 1, 1, 1) * (passing[:-1] - passing[1:])).cumsum(1)
        sums = torch.cat((functional.pad(scattered, (0, 0, 0, 0, 1, 0)), depth[None]))[None]
        return FroxelGrid(sums, view.size, near, growth, bulk, end)

    def lamp_light(self, fog: FogMedium, rays: RaySegments, lamp: LightSource, parts: int) -> Tensor:
        """In-scattered light (3, S, rows, columns) of one light, for an albedo of 1; a segment is cut into `parts`."""

        def per_color() -> Tensor:  # (S, rows, columns)
            direct = lamp.in_scattering(rays, parts)
            ways = direct.points, direct.toward, direct.distance
            strength = direct.irradiance
            if lamp.light.shadow:
                signature = rays.signature, lamp.signature()
                strength = strength * self._shadow(lamp.light.name, signature, ways, lamp.shadowless)
            strength = strength * fog.transmittance(*ways)
            strength = strength * phase((direct.toward * rays.toward[:, None]).sum(0), fog.anisotropy)
            return strength.unflatten(0, (len(rays.cuts) - 1, -1)).mean(1)

        key = None if lamp.moving else (lamp.signature(), parts)
        return self._of(fog, rays, lamp.light.name, key, per_color) * lamp.color.view(3, 1, 1, 1)

    def _of(self, fog: FogMedium, rays: RaySegments, name: str, key: Hashable, make: Callable[[], Tensor]) -> Tensor:
        """The result of `make`, cached by name until fog, rays or `key` change; not cached if they have gradients."""
        if fog.signature is None or key is None or needs_gradient(rays.start, rays.toward):
            return make()
        cut = tuple(rays.cuts.flatten()[1:2].tolist())  # () where no ray starts: the camera sees no surface
        return self._strengths.of(name, (fog.signature, rays.signature, cut, key), make)

    def _world_arriving(self, fog: FogMedium, rays: RaySegments) -> Tensor:
        """Shares (14, S, rows, columns) of the world's radiance from `DIRECTIONS` that are scattered."""
        points = rays.middles[:, None]
        directions = DIRECTIONS.to(points).view(3, -1, 1, 1, 1)  # (3, 14, SEGMENTS, rows, columns)
        everywhere = directions.expand(-1, -1, *points.shape[2:])
        far = torch.full_like(everywhere[0], math.inf)
        ways = points.expand_as(everywhere), everywhere, far
        reaching = fog.transmittance(points, directions, far) * self._shadow("", rays.signature, ways)
        return reaching * phase_shares((directions[:, :, 0] * rays.toward[:, None]).sum(0), fog.anisotropy)[:, None]

    def _shadow(self, name: str, signature: Hashable, ways: Sequence[Tensor], shadowless: int = -1) -> Tensor:
        """Visibility (0 to 1) along ways (points, directions, distances); traced again when the signature changes."""
        points, toward, distance = (way.detach() for way in ways)
        flat = points.flatten(1), toward.flatten(1), distance.flatten()
        return self._shadows.of(name, signature, lambda: self._clear(*flat, shadowless).view(distance.shape))


def phase(cosine: Tensor, g: Tensor) -> Tensor:
    """Henyey-Greenstein, 1/sr; `cosine` is 1 where light goes straight on."""
    return (1 - g * g) / (4 * math.pi) * (1 + g * g - 2 * g * cosine).clamp_min(1e-4) ** -1.5


def phase_shares(cosine: Tensor, g: Tensor) -> Tensor:
    """Share (14, ...) of the scattered light that comes from each of `DIRECTIONS`, by cosines (14, ...)."""
    lobe = phase(cosine, g) * WEIGHTS.to(cosine).view(-1, *[1] * (cosine.dim() - 1))
    return lobe / lobe.sum(0)  # 14 directions miss much of a narrow lobe, whose energy would be lost
