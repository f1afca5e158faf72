# SPDX-License-Identifier: Apache-2.0
"""From scene-linear light to the picture that an artist sees: Vibe Grade, then the scene's view transform."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor

from ...color.view_transform import ViewTransform
from ...scene import FilmSettings
from ...schema import FAMILIES
from . import grade
from .bloom import bloom

_CLEAR = 1e-3  # coverage below which colors are too uncertain to be divided by it


class Film:
    """Develops linear pictures of one size.

    Args:
        size: (width, height) in pixels.

    Raises:
        VibeError: The view transform cannot be read.
    """

    def __init__(self, spec: FilmSettings, size: tuple[int, int], device: str = "cpu") -> None:
        self._view = ViewTransform(spec.ocio, spec.display, spec.view, spec.look, device)
        self._falloff = grade.falloff(*size).to(device)

    def develop(self, linear: Tensor, values: Mapping[str, Tensor], alpha: Tensor | None = None) -> Tensor:
        """Display-encoded picture (H, W, 3) in [0, 1]; what is transparent shows black.

        Args:
            linear: (H, W, 3) scene-linear Rec.709, before the grade, times alpha.
            values: "film/…" to (1,) or (3,) in Blender's units; what is missing leaves the picture alone.
            alpha: (H, W) coverage of a transparent film; None where the background is seen.
        """
        graded = self.grade(linear, values)
        if alpha is None:
            return self.show(graded, values)
        # Blender divides by alpha before its view transform (imbuf, IMB_colormanagement), and PNGs stay so.
        alpha = alpha.clamp(0, 1)[..., None]
        return self.show(graded / alpha.clamp_min(_CLEAR), values) * alpha

    def grade(self, linear: Tensor, values: Mapping[str, Tensor]) -> Tensor:
        """The compositor group "Vibe Grade", in its order. Neutral steps that nothing learns from are skipped."""
        set_ = _Settings(values, linear)
        c = linear
        if set_.moves("glare"):
            c = c.clamp_min(0) + set_["glare"] * bloom(c)
        if set_.moves("grade_exposure"):
            c = c * torch.exp2(set_["grade_exposure"])
        if set_.moves("lift", "midtone", "gain"):
            c = grade.lift_gamma_gain(c, set_["lift"], set_["midtone"], set_["gain"])
        if set_.moves("contrast"):
            c = grade.contrast(c, set_["contrast"])
        if set_.moves("saturation"):
            c = grade.saturation(c, set_["saturation"])
        if set_.moves("hue"):
            c = grade.turn_hue(c.clamp_min(0), set_["hue"])
        if set_.moves("grade_gamma"):
            c = grade.power(c, set_["grade_gamma"])
        if set_.moves("vignette"):
            c = c * (1 - set_["vignette"] * self._falloff)
        return c

    def show(self, graded: Tensor, values: Mapping[str, Tensor]) -> Tensor:
        """Exposure, OCIO view, gamma: Blender's color management."""
        set_ = _Settings(values, graded)
        if set_.moves("exposure"):
            graded = graded * torch.exp2(set_["exposure"])
        display = self._view(graded).clamp(0, 1)
        if set_.moves("gamma"):
            display = display.clamp_min(1e-8) ** (1 / set_["gamma"])
        return display


class _Settings:
    """The film's values, with the schema's neutral ones for what is missing."""

    def __init__(self, values: Mapping[str, Tensor], like: Tensor) -> None:
        self._values, self._like = values, like

    def __getitem__(self, name: str) -> Tensor:
        key = f"film/{name}"
        value = self._values.get(key)
        return value if value is not None else self._like.new_full((1,), FAMILIES[key].default)

    def moves(self, *names: str) -> bool:
        """Whether any of them changes the picture, or could: it is being learned."""
        return any(
            self[n].requires_grad or bool((self[n] != FAMILIES[f"film/{n}"].default).any()) for n in names
        )
