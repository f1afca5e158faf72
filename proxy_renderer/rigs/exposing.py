# SPDX-License-Identifier: Apache-2.0
"""The light that a view shows as wanted: rigs speak of what people see, and views differ in how they roll off highlights and colors.

A white wall in the sun is nearly white on paper. In a view that cuts off it takes a radiance of 0.8, in AgX four times as much.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from ..color import tensors
from ..color.constants import LUMINANCE_WEIGHTS
from ..color.view_transform import ViewTransform
from ..scene import SceneData
from ..schema import Values

WHITE = 0.8  # the most luminance, on the display, that a surface is lit to
_STEPS, _STEP = 48, 0.7  # of the search for the light of a color
_LEAST, _MOST = 1e-4, 0.97  # of a channel on the display
_PUREST = 0.08  # least channel of a light, of its greatest: no view shows purer colors
_BRIGHTEST = 16.0
_PALER, _NEAR = (0.0, 0.12, 0.24, 0.36, 0.48, 0.6), 0.03
"""How far a color goes towards gray until a view can show it, and how near is near enough."""


class Exposing:
    """How much light the camera of a scene needs.

    Args:
        scene: Has the view, and the artist's own exposure, which stays.
    """

    def __init__(self, scene: SceneData) -> None:
        film = scene.film
        self._view = ViewTransform(film.ocio, film.display, film.view, film.look)
        self._stops = sum(scene.value(key)[0] for key in ("film/exposure", "film/grade_exposure"))

    def gray(self, luminance: float) -> float:
        """Scene-linear radiance of a gray that is displayed with a luminance; `WHITE` at most."""
        return self.color((min(luminance, WHITE),) * 3)[0]

    def color(self, displayed: Sequence[float]) -> Values:
        """Scene-linear light that is displayed as a linear color, or as a paler one of that hue where the view shows none so pure."""
        wanted = torch.tensor(displayed, dtype=torch.float32).clamp(_LEAST, _MOST)
        gray = wanted @ wanted.new_tensor(LUMINANCE_WEIGHTS)
        for paler in _PALER:
            aim = torch.lerp(wanted, gray, paler)
            light, miss = self._light_of(aim)
            if miss < _NEAR:
                break
        return tuple(v * 2.0**-self._stops for v in light.tolist())

    def _light_of(self, wanted: Tensor) -> tuple[Tensor, float]:
        """Light (3,) that comes near a displayed color (3,), and how far its display is from it."""
        light = shown = wanted
        for _ in range(_STEPS):
            shown = tensors.linear_from_srgb(self._view(light).clamp(0.0, 1.0))
            light = (light * ((wanted + _LEAST) / (shown + _LEAST)) ** _STEP).clamp_max(_BRIGHTEST)
            light = torch.maximum(light, _PUREST * light.max())
        return light, float((shown - wanted).abs().max())
