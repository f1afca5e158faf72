# SPDX-License-Identifier: Apache-2.0
"""A material's values in one render."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

from torch import Tensor

from ...color.tensors import luminance
from ...scene import Material
from ...scene.values import RenderValues, needs_gradient
from ..geometry.vectors import within

T = TypeVar("T")

_UNIT_INPUTS = ("metallic", "roughness", "coat", "transmission")  # from 0 to 1, may vary over a surface


@dataclass(frozen=True)
class ShadingInputs:
    """A material's values in one render: scalars () and colors (3,).

    Where nodes compute them, `metallic`, `roughness`, `coat` and `transmission` are (N,), `emission` (3, N).
    A computed emission color is multiplied by `glow_tint`, a computed strength by `glow_factor`; `emission_color` and
    `strength` are the means of the products, which other surfaces receive.
    """

    base: Tensor
    metallic: Tensor
    roughness: Tensor
    ior: Tensor
    specular: Tensor
    specular_tint: Tensor
    coat: Tensor
    coat_roughness: Tensor
    coat_ior: float
    coat_tint: tuple[float, ...]
    sheen: Tensor
    sheen_tint: tuple[float, ...]
    sheen_roughness: float
    transmission: Tensor
    emission_color: Tensor
    glow_tint: Tensor
    glow_factor: Tensor
    glow_recolor: Tensor | None
    strength: Tensor
    recolor: Tensor | None
    # what `seen` keeps; None if it keeps nothing
    kept: dict[str, tuple[Tensor, Any]] | None = field(default=None, repr=False, compare=False)

    def seen(self, name: str, view: Tensor, make: Callable[[], T]) -> T:
        """A value that depends on the inputs and a view (7, N), not on light: kept for the next render."""
        if self.kept is None or needs_gradient(view):
            return make()
        known = self.kept.get(name)
        if known is None or known[0] is not view:
            known = self.kept[name] = view, make()
        terms: T = known[1]
        return terms

    def uses(self, name: str, view: Tensor) -> bool:
        """True if the lobe of a weight can matter at a view (7, N), see `used`; asking a card's memory takes long."""
        return self.seen(f"uses {name}", view, lambda: used(getattr(self, name)))

    @property
    def emission(self) -> Tensor:
        """Emitted radiance (3,), or (3, N) where its color or its strength vary."""
        color, strength = self.emission_color, self.strength
        return color[:, None] * strength if color.dim() == strength.dim() == 1 else color * strength

    def varied(self, textured: Mapping[str, Tensor]) -> ShadingInputs:
        """The same with inputs (1 or 3, N) that vary over its samples."""
        if not textured:
            return self
        given: dict[str, Any] = {n: textured[n][0].clamp(0.0, 1.0) for n in _UNIT_INPUTS if n in textured}
        if "emission" in textured:
            given["strength"] = textured["emission"][0].clamp_min(0.0) * self.glow_factor
        if "emission_color" in textured:
            glow = textured["emission_color"]
            given["emission_color"] = _grayed(glow, self.glow_recolor) * self.glow_tint[:, None]
        return replace(self, **given)

    def colored(self, texture: Tensor | None) -> Tensor:
        """Base color (3, 1), or (3, N) where a texture (3, N) is linked."""
        if texture is None:
            return self.base[:, None]
        return _grayed(texture, self.recolor) * self.base[:, None]


def _grayed(color: Tensor, recolor: Tensor | None) -> Tensor:
    """Colors (3, N) that are reduced to their luminance by a share ()."""
    if recolor is None or not used(recolor):
        return color
    return color + (luminance(color.T).T - color) * recolor


def shading_inputs_of(
    material: Material, settings: RenderValues, kept: dict[str, tuple[Tensor, Any]] | None = None
) -> ShadingInputs:
    """The values of one material, which keep in `kept` what follows from them."""
    key = f"material/{material.name}/"
    constants = material.constants
    textured = material.texture is not None
    base = settings.color(key + ("tint" if textured else "base_color"), 1.0 if textured else 0.8)

    glow_tint = settings.color(key + "emission_color", 1.0)
    glow_factor = settings.scalar(key + "emission")
    color, strength = (material.maps.get(name) for name in ("emission_color", "emission"))
    recolor = settings.scalar(key + "recolor") if textured or color else None
    glow_recolor = None if textured else recolor
    glow = glow_tint
    if color:
        mean = glow_tint.new_tensor(color.image.mean((0, 1)))[:, None]
        glow = glow_tint * _grayed(mean, glow_recolor)[:, 0]

    def unit(name: str, default: float) -> Tensor:
        return within(settings.scalar(key + name, default), 0.0, 1.0)

    return ShadingInputs(
        base=within(base, 0.0, math.inf),
        metallic=unit("metallic", 0.0),
        roughness=unit("roughness", 0.5),
        ior=within(settings.scalar(key + "ior", 1.5), 1.0, 10.0),
        specular=within(settings.scalar(key + "specular", 0.5), 0.0, math.inf),
        specular_tint=within(settings.color(key + "specular_tint", 1.0), 0.0, math.inf),
        coat=unit("coat", 0.0),
        coat_roughness=unit("coat_roughness", 0.03),
        coat_ior=max(float(constants.get("coat_ior", 1.5)), 1.0),
        coat_tint=tuple(constants.get("coat_tint", (1.0, 1.0, 1.0))),
        sheen=unit("sheen", 0.0),
        sheen_tint=tuple(constants.get("sheen_tint", (1.0, 1.0, 1.0))),
        sheen_roughness=float(constants.get("sheen_roughness", 0.5)),
        transmission=unit("transmission", 0.0),
        emission_color=glow,
        glow_tint=glow_tint,
        glow_factor=glow_factor,
        glow_recolor=glow_recolor,
        strength=glow_factor * float(strength.image[..., 0].mean()) if strength else glow_factor,
        recolor=recolor if textured else None,
        kept=kept,
    )


def used(weight: Tensor) -> bool:
    """True if a lobe can matter: its weight is not zero, or somebody wants its gradient."""
    return needs_gradient(weight) or bool((weight != 0).any())
