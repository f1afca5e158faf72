# SPDX-License-Identifier: Apache-2.0
"""The direction of the key light in a reference image of the same scene, found with the proxy before the search.

A misplaced shadow has no gradient toward its right place, so gradients find directions worst. Light adds up: for each direction one
image has the key's light alone, and another that of all other lights. Sums of the two, with several strengths of the key, are
compared with the reference image. Only the pattern of lightness is compared, because exposure and grade are not known yet.
"""

import itertools
from operator import itemgetter

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
    """The point u (N,) with the key light turned, in the box, to its direction in the sRGB image `goal` (H, W, 3).

    u itself if no direction is better, or unless the scene has exactly one key light that may turn.
    """
    turning = [
        key
        for key, instance in vector.instances.items()
        if instance.parameter.family == "light/azimuth"
        and instance.role == "key"
        and bool((upper > lower)[vector.slices[key]].all())
    ]
    if len(turning) != 1:
        return u
    light = turning[0].removesuffix("/azimuth")
    angles = f"{light}/azimuth", f"{light}/elevation"
    likeness = _Likeness(scene, vector, light, u, goal)

    def tried(azimuth: float, elevation: float) -> tuple[float, Tensor]:
        values = vector.encode({angles[0]: (azimuth,), angles[1]: (elevation,)})
        point = torch.where(vector.mark(angles), values, u).clamp(lower, upper)
        return likeness(point), point

    here, own = likeness(u), vector.instances[angles[0]].value[0]
    coarse = [tried(own + turn, height) for turn, height in itertools.product(_TURNS, _HEIGHTS)]
    best = max([(here, u), *coarse], key=itemgetter(0))
    (azimuth,), (elevation,) = (vector.plain(best[1])[angle] for angle in angles)
    most, point = max([best, *(tried(azimuth + turn, elevation + rise) for turn, rise in _FINER)], key=itemgetter(0))
    return point if most > here + _BETTER else u


class _Likeness:
    """Compares the image `goal` (H, W, 3) with the scene at points that differ from u (N,) in one light's direction."""

    def __init__(self, scene: SceneData, vector: ParameterVector, light: str, u: Tensor, goal: Tensor) -> None:
        self._proxy, self._vector = Proxy(scene, picture_size(scene.resolution, _SIZE)), vector
        self._goal = _cells(goal)
        energies = (f"{light}/{name}" for name in ("power", "strength"))
        dark = {next(key for key in energies if key in vector.instances): torch.zeros(1)}
        with torch.no_grad():
            self._rest = self._proxy.render(vector.decode(u) | dark).linear

    @torch.no_grad()
    def __call__(self, u: Tensor) -> float:
        """The greatest correlation of lightness between `goal` and images of u (N,), over strengths and exposures."""
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
