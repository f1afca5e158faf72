# SPDX-License-Identifier: Apache-2.0
"""A material's shading inputs in one render: constants, textures over UVs, and nodes baked from the exported camera."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import torch
from torch import Tensor
from torch.nn.functional import grid_sample, interpolate

from ...color.tensors import luminance
from ...scene import Material, SceneData, Texture
from ...scene.values import RenderValues, needs_gradient
from ..geometry.camera import view_of
from ..geometry.vectors import dot, length, within
from ..geometry.visibility import RayGeometry, Surface

T = TypeVar("T")

_UNIT_INPUTS = ("metallic", "roughness", "coat", "transmission")  # from 0 to 1, may vary over a surface
_LEVELS = 7  # number of sizes of a texture, each half of the previous size


@dataclass(frozen=True)
class ShadingInputs:
    """A material's inputs in one render: scalars () and colors (3,).

    Textured inputs have a value for each of N samples (see `varied`): (N,) for `metallic`, `roughness`, `coat` and
    `transmission`, (3, N) for `emission`. A textured emission color is multiplied by `glow_tint`, a textured strength
    by `glow_factor`. Before `varied`, `emission_color` and `strength` have the means of these products, by which
    the material lights other surfaces.
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
    glow_recolor: Tensor | None  # () share by which a textured emission color is grayed; None if it is not
    strength: Tensor
    recolor: Tensor | None  # () share by which a textured base color is grayed; None if it is not
    # results of `seen` by name, each with its `view`; None if none are kept
    kept: dict[str, tuple[Tensor, Any]] | None = field(default=None, repr=False, compare=False)

    def seen(self, name: str, view: Tensor, make: Callable[[], T]) -> T:
        """The result of `make`, kept by name for further renders with the same `view`, an albedo basis (7, N).

        It may depend on these inputs and `view` only. It is not kept if `view` needs gradients or `kept` is None.
        """
        if self.kept is None or needs_gradient(view):
            return make()
        known = self.kept.get(name)
        if known is None or known[0] is not view:
            known = self.kept[name] = view, make()
        return known[1]

    def uses(self, name: str, view: Tensor) -> bool:
        """True if the weight in the field `name` is `used`; kept by `view`, because reading a GPU's memory is slow."""
        return self.seen(f"uses {name}", view, lambda: used(getattr(self, name)))

    @property
    def emission(self) -> Tensor:
        """Emitted radiance (3,), or (3, N) where its color or its strength vary."""
        color, strength = self.emission_color, self.strength
        return color[:, None] * strength if color.dim() == strength.dim() == 1 else color * strength

    def varied(self, textured: Mapping[str, Tensor]) -> ShadingInputs:
        """A copy with textured inputs for N samples; `textured`: name of the input -> values (1 or 3, N)."""
        if not textured:
            return self
        given: dict[str, Any] = {n: textured[n][0].clamp(0.0, 1.0) for n in _UNIT_INPUTS if n in textured}
        if "emission" in textured:
            given["strength"] = textured["emission"][0].clamp_min(0.0) * self.glow_factor
        if "emission_color" in textured:
            given["emission_color"] = _grayed(textured["emission_color"], self.glow_recolor) * self.glow_tint[:, None]
        return replace(self, **given)

    def colored(self, texture: Tensor | None) -> Tensor:
        """Base color (3, 1), or (3, N) if a texture (3, N) is linked."""
        if texture is None:
            return self.base[:, None]
        return _grayed(texture, self.recolor) * self.base[:, None]


def _grayed(color: Tensor, recolor: Tensor | None) -> Tensor:
    """Colors (3, N) moved towards the gray of the same luminance by a share `recolor` ()."""
    if recolor is None or not used(recolor):
        return color
    return color + (luminance(color.T).T - color) * recolor


def shading_inputs_of(
    material: Material, settings: RenderValues, kept: dict[str, tuple[Tensor, Any]] | None = None
) -> ShadingInputs:
    """The shading inputs of one material; `kept` is a dict for terms computed from them, see `ShadingInputs.seen`."""
    key, constants, textured = f"material/{material.name}/", material.constants, material.texture is not None
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
    """True if a lobe must be computed: its weight is not zero everywhere, or needs a gradient."""
    return needs_gradient(weight) or bool((weight != 0).any())


class MaterialTextures:
    """All textures of a scene's materials; those baked from the exported camera are downsampled to a render's size."""

    def __init__(self, scene: SceneData, device: torch.device, size: tuple[int, int] | None = None) -> None:
        self._scene = scene
        with torch.no_grad():
            self._view = view_of(scene, RenderValues(scene, {}, device), scene.resolution).detached()
            self._images = {
                (number, name): _image(texture, device, size)
                for number, material in enumerate(scene.materials)
                for name, texture in {"base_color": material.texture, **material.maps}.items()
                if texture is not None
            }

    def has(self, material: int, name: str) -> bool:
        """True if a texture gives the input `name` of a material; "base_color" is `Material.texture`."""
        return (material, name) in self._images

    def at(self, material: int, name: str, surface: Surface) -> Tensor:
        """Texture values (C, N) of a material's input at N surface points; differentiable in their positions."""
        row = self._scene.materials[material]
        texture = row.texture if name == "base_color" else row.maps[name]
        assert texture is not None
        place = self._place(texture, surface)
        if texture.extension == "REPEAT":
            place = place - place.detach().floor()
        padding = "zeros" if texture.extension == "CLIP" else "border"
        grid = (place * 2 - 1).T[None, None]
        return grid_sample(self._images[material, name], grid, padding_mode=padding, align_corners=False)[0, :, 0]

    def _place(self, texture: Texture, surface: Surface) -> Tensor:
        """Texture coordinates (2, N) of points, [0, 1] from the lower left."""
        if texture.window is not None:
            return self._through(texture.window, surface.position)
        if texture.plane is not None:
            rows = surface.position.new_tensor(texture.plane)
            return rows[:, :3] @ surface.position + rows[:, 3:]
        return surface.uv

    def relative_base_color(self, surface: Surface, geometry: RayGeometry) -> Tensor | None:
        """Base colors (3, N) over their texture's mean, 1 where none covers a point; None if no point has a texture."""
        result = None
        for material, row in enumerate(self._scene.materials):
            index = (surface.material == material).nonzero()[:, 0]
            if row.texture is None or not len(index):
                continue
            far = row.maps.get("far")
            if far is not None:
                place = self._place(far, surface.pick(index))
                index = index[((place > 0) & (place < 1)).all(0)]
            elif row.texture.window is not None:
                index = index[self._seen(row.texture.window, surface.pick(index), geometry)]
            part = surface.pick(index)
            if far is not None and len(index) > 1:
                sampled = self._footprints(self._images[material, "far"], self._place(far, part))
            else:
                sampled = self.at(material, "base_color" if far is None else "far", part)
            mean = self._images[material, "base_color"].mean((2, 3)).view(3, 1).clamp_min(1e-3)
            result = torch.ones_like(surface.position) if result is None else result
            result = result.index_copy(1, index, sampled / mean)
        return result

    def _seen(self, window: tuple[float, float, float, float], surface: Surface, geometry: RayGeometry) -> Tensor:
        """(N,) bool: points that the exported camera sees inside a window of its image, not hidden by others."""
        place = self._through(window, surface.position)
        offset, ahead = surface.position - self._view.position[:, None], -self._view.rotation[:, 2:3]
        depth = dot(ahead.expand_as(offset), offset)
        if self._view.orthographic:
            offset = ahead * depth
        distance = length(offset)
        open_ = geometry.clear(surface.position - offset, offset / distance, distance * (1 - 1e-3), ray="camera")
        return ((place > 0) & (place < 1)).all(0) & (depth > 0) & (open_ > 0)

    def _footprints(self, image: Tensor, place: Tensor) -> Tensor:
        """Colors (3, N) of an image (1, 3, H, W) at places (2, N), each averaged over the way to the next place."""
        # In a mirror, much of a texture may fall into one pixel.
        step = (place[:, 1:] - place[:, :-1]).abs().amax(0) * image.shape[-1]
        level = torch.cat((step, step[-1:])).clamp_min(1.0).log2().clamp_max(_LEVELS - 1)
        grid = (place * 2 - 1).T[None, None]
        result = torch.zeros((3, place.shape[1]), device=place.device)
        for number in range(_LEVELS):
            share = (1 - (level - number).abs()).clamp_min(0.0)
            result = result + grid_sample(image, grid, padding_mode="border", align_corners=False)[0, :, 0] * share
            image = interpolate(image, scale_factor=0.5, mode="area") if min(image.shape[2:]) > 1 else image
        return result

    def _through(self, window: tuple[float, float, float, float], points: Tensor) -> Tensor:
        """Places (2, N) of points (3, N) in a window of the exported camera's image, [0, 1] from the lower left."""
        pixel = self._view.project(points)
        x, y = pixel[0] / self._view.size[0], 1 - pixel[1] / self._view.size[1]
        left, bottom, right, top = window
        return torch.stack(((x - left) / (right - left), (y - bottom) / (top - bottom)))


def _image(texture: Texture, device: torch.device, size: tuple[int, int] | None) -> Tensor:
    """The texture as (1, C, H, W), row 0 at the bottom; a texture baked from the camera is downsampled to `size`."""
    image = torch.from_numpy(texture.image).to(device).permute(2, 0, 1)[None]
    if size is None or texture.window is None:
        return image
    left, bottom, right, top = texture.window
    wanted = max(1, round(size[1] * (top - bottom))), max(1, round(size[0] * (right - left)))
    return interpolate(image, (min(wanted[0], image.shape[2]), min(wanted[1], image.shape[3])), mode="area")


class MaterialOpacity:
    """Alpha of surfaces; `clear` (M,) bool has the materials that are not opaque everywhere."""

    def __init__(self, scene: SceneData, device: torch.device) -> None:
        self._maps = MaterialTextures(scene, device)
        self._alpha = torch.tensor([m.alpha for m in scene.materials], device=device).clamp(0, 1)
        mapped = ((i, m.maps["alpha"]) for i, m in enumerate(scene.materials) if "alpha" in m.maps)
        self._seen_only = {i: texture.window is not None for i, texture in mapped}
        self.clear = self._alpha < 1
        self.clear[[*self._seen_only]] = True

    def at(self, surface: Surface, by_camera: bool = False) -> Tensor:
        """Alpha (N,) of surface points.

        A map baked from the exported camera is read only if it sees the points directly (`by_camera`); else its mean
        is.
        """
        alpha = self._alpha[surface.material]
        for material, seen_only in self._seen_only.items():
            index = (surface.material == material).nonzero()[:, 0]
            if len(index) and (by_camera or not seen_only):
                sampled = self._maps.at(material, "alpha", surface.pick(index))
                alpha = alpha.index_copy(0, index, sampled.mean(0).clamp(0, 1))
        return alpha


def geometry_of(scene: SceneData, device: torch.device) -> RayGeometry:
    """The scene's triangles, with the opacity of their materials."""
    hidden = [frozenset(thing.hidden) for thing in scene.objects]
    glassy = torch.tensor(
        ["transmission" in m.maps or scene.value(f"material/{m.name}/transmission")[0] > 0.0 for m in scene.materials]
    )
    opacity = MaterialOpacity(scene, device)
    return RayGeometry(scene.mesh, hidden, opacity.at, opacity.clear, glassy)
