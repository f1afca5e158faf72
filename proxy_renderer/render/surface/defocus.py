# SPDX-License-Identifier: Apache-2.0
"""Depth of field: what lies out of focus is blurred over the circle of confusion of its depth.

The image is cut into layers of about the same blur, each is blurred by a disc, and they are laid over each other from far to
near. Parts of layers that a near object hides are filled from what they show around it.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

from ...scene import Camera
from ..geometry.camera import View
from ..geometry.samples import pixel_centers
from ..geometry.vectors import dot

_FIRST, _GROWTH = 0.75, 1.5  # pixels of the first blurred layer's radius, and the next ones' ratio
_MOST = 0.12  # largest radius, in parts of the image's longer side
_LEAST = 0.2  # radius in pixels below which a whole image counts as sharp


@dataclass(frozen=True)
class Defocus:
    """The blur of one view; a constant for gradients, which pass through the colors."""

    size: tuple[int, int]  # width and height of the image in pixels
    # from far to near: a layer's opacity (H, W), and the Fourier spectrum of the disc that blurs it; None if it is sharp
    layers: list[tuple[Tensor, Tensor | None]]
    padded: tuple[int, int]  # height and width that convolutions are done at

    @staticmethod
    def of(camera: Camera, view: View, distance: Tensor) -> Defocus | None:
        """The blur of a view with distances (H, W) along the pixels' rays, infinite for the background; None where all is sharp."""
        if camera.aperture <= 0:
            return None
        # Signed radius (H, W) of a thin lens's circles of confusion, as in Cycles: pixels, below 0 behind the plane in focus.
        toward = view.rays(pixel_centers(view.size).to(distance.device))[1]
        ahead = -view.rotation[:, 2:3]
        depth = (distance.flatten() * dot(ahead, toward)).view(distance.shape)
        focus = camera.focus_distance
        if camera.focus_point is not None:
            offset = torch.tensor(camera.focus_point, device=distance.device) - view.position
            focus = float(dot(ahead, offset[:, None]).abs())
        focus = max(focus, 1e-4)
        blur = 1 - depth / focus if view.orthographic else 1 / depth.clamp_min(1e-6) - 1 / focus
        pixel = float(view.scale) * view.extent[0] / view.size[0]
        most = _MOST * max(view.size)
        radius = (blur * (camera.aperture / pixel)).clamp(-most, most)
        if float(radius.abs().max()) < _LEAST:
            return None
        knots = _knots(float(radius.min()), float(radius.max()))
        pad = int(max(abs(k) for k in knots)) + 1
        padded = distance.shape[0] + pad, distance.shape[1] + pad
        layers = []
        for number, knot in enumerate(knots):
            # 1 from its radius half way to its neighbors' radii, 0 at those; at every pixel, one layer is opaque.
            share = torch.ones_like(radius)
            for neighbor in (*knots[number - 1 : number], *knots[number + 1 : number + 2]):
                share = torch.minimum(share, (radius - neighbor) / (knot - neighbor))
            disc = _disc(abs(knot), padded).to(radius.device) if knot else None
            layers.append(((2 * share).clamp(0.0, 1.0), disc))
        return Defocus(view.size, layers, padded)

    def __call__(self, picture: Tensor) -> Tensor:
        """The blurred image (C, P) of a linear one (C, P); differentiable."""
        width, height = self.size
        sharp = picture.view(-1, height, width)
        total = torch.zeros((len(sharp) + 1, height, width), device=picture.device)
        for opacity, disc in self.layers:
            layer = torch.cat((sharp * opacity, opacity[None]))
            if disc is not None:
                spectrum = torch.fft.rfft2(layer, s=self.padded) * disc
                layer = torch.fft.irfft2(spectrum, s=self.padded)[:, :height, :width]
            total = total * (1 - layer[-1:].clamp(0.0, 1.0)) + layer
        return (total[:-1] / total[-1:].clamp_min(1e-3)).clamp_min(0.0).view(picture.shape)


def _knots(least: float, greatest: float) -> list[float]:
    """Signed radii of the layers, from far to near, 0 among them."""
    knots = [0.0]
    while knots[0] > least:
        knots.insert(0, knots[0] * _GROWTH or -_FIRST)
    while knots[-1] < greatest:
        knots.append(knots[-1] * _GROWTH or _FIRST)
    return knots


def _disc(radius: float, size: tuple[int, int]) -> Tensor:
    """Fourier spectrum of a disc with a radius in pixels, whose weights sum to 1, centered on the first pixel."""
    y, x = (torch.minimum(torch.arange(n), n - torch.arange(n)).float() for n in size)
    away = (y[:, None].square() + x.square()).sqrt()
    weight = (radius + 0.5 - away).clamp(0.0, 1.0)
    return torch.fft.rfft2(weight / weight.sum())
