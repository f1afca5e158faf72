# SPDX-License-Identifier: Apache-2.0
"""The direction of the key light in a reference image of the same scene, found with the proxy before the search.

A misplaced shadow has no gradient toward its right place, so gradients find directions worst. Light adds up: for each direction one
image has the key's light alone, and another that of all other lights. Sums of the two, with several strengths of the key, are
compared with the reference image. Only the pattern of lightness is compared, because exposure and grade are not known yet.
"""

import itertools
from collections.abc import Iterable

import torch
import torch.nn.functional as F
from torch import Tensor

from ...color.tensors import lab_from_srgb
from ...render.proxy import Proxy
from ...scene import SceneData
from ..shots import picture_size
from ..vector import ParameterVector

_TURNS = tuple(range(-180, 180, 40))  # degrees of azimuth from the artist's direction
_HEIGHTS = (20.0, 50.0)  # degrees of elevation
_FINER = ((-20, 0), (20, 0), (0, -15), (0, 15))  # (azimuth, elevation) degrees from the best direction so far
_SIZE = 48  # longer side of the images, pixels
_STRENGTHS, _EXPOSURES = (0.25, 0.5, 1.0, 2.0, 4.0), (0.5, 1.0, 2.0)  # factors on the key, and on all light
_CELLS = 24  # rows and columns of the grid whose cells are compared
_BETTER = 0.01  # least gain in correlation over the artist's direction


def with_key_turned(
    scene: SceneData, vector: ParameterVector, u: Tensor, lower: Tensor, upper: Tensor, goal: Tensor
) -> Tensor:
    """The point u (N,) with the key light turned, in the box, to its direction in an sRGB image (H, W, 3).

    u itself if no direction is better, or if the scene has not exactly one key light that may turn.
    """
    keys = [
        key
        for key, instance in vector.instances.items()
        if instance.parameter.family == "light/azimuth"
        and instance.role == "key"
        and bool((upper > lower)[vector.slices[key]].all())
    ]
    if len(keys) != 1:
        return u
    turned = _TurnedKey(scene, vector, keys[0].removesuffix("/azimuth"), u, goal)
    here = turned.likeness(u)
    own = vector.instances[keys[0]].value[0]
    coarse = [(own + turn, height) for turn, height in itertools.product(_TURNS, _HEIGHTS)]
    best, most = turned.best_of(coarse, (lower, upper), (u, here))
    azimuth, elevation = turned.direction(best)
    finer = [(azimuth + turn, elevation + rise) for turn, rise in _FINER]
    best, most = turned.best_of(finer, (lower, upper), (best, most))
    return best if most > here + _BETTER else u


class _TurnedKey:
    """Compares an image with the scene at u whose key light is turned to other directions."""

    def __init__(self, scene: SceneData, vector: ParameterVector, light: str, u: Tensor, goal: Tensor) -> None:
        self._proxy = Proxy(scene, picture_size(scene.resolution, _SIZE))
        self._vector, self._u = vector, u
        self._keys = f"{light}/azimuth", f"{light}/elevation"
        energies = (f"{light}/{name}" for name in ("power", "strength"))
        self._power = next(key for key in energies if key in vector.instances)
        self._goal = _cells(goal)
        with torch.no_grad():
            dark = {self._power: torch.zeros(1)}
            self._rest = self._proxy.render(vector.decode(u) | dark).linear

    def point(self, azimuth: float, elevation: float) -> Tensor:
        """(N,) the point u with the key light in a direction, degrees."""
        values = self._vector.encode(dict(zip(self._keys, ((azimuth,), (elevation,)), strict=True)))
        point = self._u.clone()
        for key in self._keys:
            point[self._vector.slices[key]] = values[self._vector.slices[key]]
        return point

    def direction(self, u: Tensor) -> tuple[float, float]:
        """Azimuth and elevation at u (N,), degrees."""
        values = self._vector.plain(u)
        return values[self._keys[0]][0], values[self._keys[1]][0]

    def best_of(
        self, directions: Iterable[tuple[float, float]], box: tuple[Tensor, Tensor], best: tuple[Tensor, float]
    ) -> tuple[Tensor, float]:
        """The point most like the image, and its likeness, among directions (azimuth, elevation), in degrees, and the best so far."""
        for azimuth, elevation in directions:
            point = self.point(azimuth, elevation).clamp(*box)
            if (likeness := self.likeness(point)) > best[1]:
                best = point, likeness
        return best

    @torch.no_grad()
    def likeness(self, u: Tensor) -> float:
        """The greatest correlation of lightness with the image, over strengths of the key and exposures."""
        key = self._proxy.render(self._vector.decode(u)).linear - self._rest
        tried = itertools.product(_STRENGTHS, _EXPOSURES)
        lights = [(exposure * (strength * key + self._rest)).clamp_min(0.0) for strength, exposure in tried]
        # Developing all images in one call is faster.
        shown = self._proxy.film.show(torch.cat(lights), {}).view(-1, *key.shape)
        rows = torch.cat([self._goal, *map(_cells, shown)]).view(len(lights) + 1, -1)
        return float(torch.nan_to_num(torch.corrcoef(rows)[0, 1:]).max())


def _cells(display: Tensor) -> Tensor:
    """(n,) mean L* of the cells of a grid over an image (H, W, 3)."""
    return F.adaptive_avg_pool2d(lab_from_srgb(display)[..., 0][None, None], _CELLS).flatten()
