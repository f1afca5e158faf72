# SPDX-License-Identifier: Apache-2.0
"""The anchor: a Cycles render of known values, and the correction of the proxy that follows from it.

With the proxy's linear image P(θ), Cycles' image A at θ₀, and for every light g its part A_g of A, the proxy's image P_g(θ₀) with
g alone, and the color s_g(θ) of its light,

    R(θ) = c P(θ) + Σ_g (A_g - c P_g(θ₀)) s_g(θ) / s_g(θ₀),      c ≈ A / P(θ₀), smoothed and bounded.

R(θ₀) is A for any c. If only colors and powers of lights differ from θ₀, R(θ) is what Cycles would render, because light adds up.
Otherwise R has c times the proxy's own gradient. c and the residuals are constants for gradients.

The anchor also keeps the proxy's own image of each light. If only powers and colors change, a new image is a weighted sum of
these layers.

Smoothing and look-ups do not cross outlines: Kopf et al., "Joint Bilateral Upsampling", 2007, with object and material in place
of colors.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from torch.nn.functional import embedding_bag, max_pool2d

from ..scene import SceneData
from ..schema import VibeError, split_key
from .geometry.camera import View
from .geometry.vectors import overlap
from .geometry.visibility import Hits, RayGeometry
from .lights.environment import has_own_backdrop
from .surface.view_cache import ViewCache

Tensors = Mapping[str, Tensor]

REST = "rest"  # owner of light that belongs to no light group: of glowing surfaces, and of what cannot be grouped
_RATIO = 4.0  # largest c, and inverse of the smallest
_DARK = 0.02  # in mean radiances: darker pixels count as equally dark
_FAINT = 2e-3  # in mean radiances: ratios between darker pixels are unreliable
_BRIGHTER = 16.0  # largest factor by which a residual grows with its light
_LAYER_BRIGHTER = 8.0  # the same for a layer: layers of lights that were nearly off are noise
_OFF = 1e-9  # color below which a light counts as off
_LEAST = 0.05  # share of c P that must remain of a pixel after residuals
_HAZY = 0.05  # in mean radiances: darker parts of the proxy are smoothed as if they were even
_FAR = 1e4  # distance at which the background is looked up, in sizes of the scene
_RADIUS, _SIGMA = 2, 1.0  # pixels: radius and standard deviation of the smoothing
_REACH = 2.0  # radius of a look-up, in pixels of the anchor
_ALIKE = 0.5  # width in stops within which pixels count as equally bright
_LEAST_WEIGHT = 1e-3  # least sum of weights in a look-up; a pixel exactly at the place has 4
_OUTLINE = 0.2  # weight of pixels next to an outline, which show two surfaces
_BRIGHTEST = 1e4  # radiance to which Cycles' pixels are clipped
_ROUNDING = 1e-3  # share of a pixel below which light outside all groups counts as a rounding error


@dataclass
class Correction:
    """The constants with which an anchor, a Cycles image at values θ₀, corrects the proxy, see the module's formula."""

    view: View  # the camera of the anchor
    guide: Tensor  # (H, W) int64 number for the object and material that a pixel shows; -1 for none
    colors: Tensors  # owner of a light, "light/NAME" or "world" -> its color s_g(θ₀), (3,)
    values: Tensors  # θ₀: parameter key -> components
    dark: float  # radiance below which pixels count as equally dark
    stops: Tensor  # (P,) brightness of the proxy's image at θ₀, in stops
    parts: Tensors  # owner -> the proxy's own image (3, P) of the owner's light at θ₀
    rest: Tensor  # (3, P) the proxy's own image of light without an owner, from glowing surfaces, at θ₀
    fields: Tensor  # (3 (2 + G), P): c, the least share of the proxy's image that must remain, the owners' residuals
    owners: tuple[str, ...]  # the G owners that Cycles' image has parts of, `REST` among them
    _kept: tuple[ViewCache, Tensor] | None = field(default=None, repr=False)  # see `samples`: a view, its fields

    @staticmethod
    def of(
        picture: CyclesPicture, whole: Tensor, parts: Tensors, colors: Tensors, values: Tensors, cache: ViewCache
    ) -> Correction:
        """The correction from Cycles' image and the proxy's own images of the same values.

        The proxy's are `whole` (3, P), with all light, and `parts`: owner -> image (3, P) of the owner's light alone.
        """
        guide = _names(cache.samples.center_hits, cache.geometry).view(cache.depth.shape)
        known_owners = [owner for owner in picture.parts if owner in parts]
        reference = picture.whole.flatten(0, 1).T.to(whole)  # (3, P)
        if not picture.denoised:  # take the proxy's detail instead of the noise
            above, below, faint = _compared(reference, whole, guide)
            reference = (whole.clamp_min(0.0) + faint) * above / (below + faint)
        above, below, faint = _compared(reference, whole, guide)
        ratio = ((above + faint) / (below + faint)).clamp(1 / _RATIO, _RATIO)  # c
        # What every owner's light adds to c times its part of the proxy's image.
        alone = [parts[owner] for owner in known_owners]
        proxy = torch.stack([*alone, whole - sum(alone, torch.zeros_like(whole))])  # (G, 3, P)
        residuals = _shares(picture, known_owners, proxy, guide) * reference - ratio * proxy
        least = torch.minimum(_LEAST * ratio, reference / whole.clamp_min(faint))
        fields = torch.cat((ratio, least, residuals.flatten(0, 1)))
        values = {key: value.detach() for key, value in values.items()}
        dark = 1e-6 + _DARK * float(whole.mean())
        kept = cache.view, guide, colors, values, dark, _stops(whole, dark), parts
        rest = whole - sum(parts.values(), torch.zeros_like(whole))
        return Correction(*kept, rest, fields, (*known_owners, REST))

    def pixels(self, linear: Tensor, colors: Tensors, fields: Tensor | None = None) -> Tensor:
        """The proxy's image `linear` (3, P), corrected at the current `colors`: owner -> color (3,) of its light.

        `fields` (3 (2 + G), P) are those of the P pixels or samples; None for pixels of the anchor's own view.
        """
        fields = self.fields if fields is None else fields
        corrected = fields[:3] * linear
        for residual, owner in zip(fields[6:].split(3), self.owners, strict=True):
            before, now = self.colors.get(owner), colors.get(owner)
            if before is None or now is None:  # `REST` has no color
                corrected = corrected + residual
            else:  # times s_g(θ) / s_g(θ₀), 0 for a light that was off
                growth, off = _grown(before, now)
                corrected = corrected + residual * torch.where(off, 0.0, growth).clamp_max(_BRIGHTER)[:, None]
        return torch.maximum(corrected, fields[3:6] * linear)

    def samples(
        self, radiance: Tensor, colors: Tensors, view: View, cache: ViewCache, before: Callable[[], Tensor]
    ) -> Tensor:
        """Corrected `radiance` (3, N) of another view's samples. Correcting samples, not pixels, keeps outlines smooth.

        `before` renders the proxy's radiance (3, N) of these samples at θ₀. Fields are looked up where the anchor saw
        the same surface; elsewhere the radiance stays as it is.
        """
        if self._kept is None or self._kept[0] is not cache:
            with torch.no_grad():
                samples, geometry = cache.samples, cache.geometry
                neutral = torch.zeros(len(self.fields), device=self.fields.device)
                neutral[:3] = 1.0
                reach = samples.hits.distance.clamp_max(_FAR * geometry.size)
                place = self.view.project(samples.origin + samples.toward * reach)
                bright = None if view.moving else (self.stops, _stops(before(), self.dark))
                names = _names(samples.hits, geometry)
                self._kept = cache, look_up(self.fields, self.guide, place, names, neutral, bright)
        return self.pixels(radiance, colors, self._kept[1])

    def has_layers_for(self, values: Tensors, scene: SceneData) -> bool:
        """True if `values` differ from θ₀ only in powers and colors of lights, or in the film, so `layered` applies."""
        for key in values.keys() | self.values.keys():
            if not key.startswith("film/") and not is_of_light(key, scene):
                own = torch.tensor(scene.value(key), dtype=torch.float32)
                one, other = (each.get(key, own).detach().reshape(-1).cpu().float() for each in (values, self.values))
                if not torch.equal(one, other):
                    return False
        return True

    def layered(self, colors: Tensors) -> Tensor | None:
        """The proxy's own image (3, P) as a sum of its parts, at other `colors`: owner -> color (3,) of its light.

        None if a light that is on now was off at θ₀, or has become more than eight times brighter.
        """
        whole = self.rest
        for owner, part in self.parts.items():
            growth, off = _grown(self.colors[owner], colors[owner])
            if bool((growth > _LAYER_BRIGHTER).any()) or bool((off & (colors[owner] > _OFF)).any()):
                return None
            whole = whole + part * growth[:, None]
        return whole


def _grown(before: Tensor, now: Tensor) -> tuple[Tensor, Tensor]:
    """Ratio (3,) of a light's color `now` to `before`, 1 where it was off; and (3,) bool, True where it was off."""
    off = before < _OFF
    return torch.where(off, 1.0, now / torch.where(off, 1.0, before)), off


def _stops(linear: Tensor, dark: float) -> Tensor:
    """Brightness (N,) of linear colors (3, N), in stops; much darker colors than `dark` get its brightness."""
    return torch.log2(linear.clamp_min(0.0).mean(0) + dark)


def _names(hits: Hits, geometry: RayGeometry) -> Tensor:
    """(N,) int64 number for the object and material that each ray meets; -1 for none."""
    index = hits.triangle.clamp_min(0)
    return torch.where(hits.hit, geometry.object[index] * 4096 + geometry.material[index], -1)


def _compared(reference: Tensor, whole: Tensor, guide: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Cycles' and the proxy's image (3, P), both smoothed, and a radiance () below which their ratio is unreliable."""
    above, below = blur(torch.cat((reference, whole)), guide).split(3)
    return above, below.clamp_min(0.0), 1e-6 + _FAINT * reference.mean()


def _shares(picture: CyclesPicture, known_owners: list[str], proxy: Tensor, guide: Tensor) -> Tensor:
    """Shares (G, 3, P) of Cycles' image: each known owner's, last the rest's; `proxy` (G, 3, P): the proxy's parts."""
    other = sum((p for o, p in picture.parts.items() if o not in known_owners), picture.rest)
    noisy = torch.stack([*(picture.parts[owner] for owner in known_owners), other])
    noisy = noisy.flatten(1, 2).transpose(1, 2).to(proxy)  # (G, 3, P)
    model = proxy.clamp_min(0.0) + _HAZY * proxy.abs().mean()
    # Noise is removed by smoothing the ratio to the proxy's part, whose sharp shadows stay.
    above, below = (blur(p.flatten(0, 1), guide) for p in (noisy, model))
    parts = model * (above / below.clamp_min(1e-20)).view_as(model)
    total = parts.sum(0)
    shares = parts / total.clamp_min(1e-20)
    shares[-1] = torch.where(total > 1e-20, shares[-1], 1.0)
    return shares


def blur(fields: Tensor, guide: Tensor) -> Tensor:
    """Gaussian averages (C, P) of fields (C, P) over each pixel's neighbors that have the same number in the guide (H, W)."""
    height, width = guide.shape
    picture = fields.view(-1, height, width)
    total, weights = torch.zeros_like(picture), torch.zeros_like(picture[0])
    for dy in range(-_RADIUS, _RADIUS + 1):
        for dx in range(-_RADIUS, _RADIUS + 1):
            (y, from_y), (x, from_x) = overlap(dy, height), overlap(dx, width)
            weight = torch.exp(torch.tensor(-(dx * dx + dy * dy) / (2 * _SIGMA * _SIGMA))).to(fields)
            same = weight * (guide[y, x] == guide[from_y, from_x])
            total[:, y, x] += same * picture[:, from_y, from_x]
            weights[y, x] += same
    return (total / weights).view_as(fields)


def look_up(
    fields: Tensor,
    guide: Tensor,
    place: Tensor,
    names: Tensor,
    neutral: Tensor,
    stops: tuple[Tensor, Tensor] | None = None,
) -> Tensor:
    """Weighted averages (C, N) of an image's fields (C, P) around places (2, N) in pixels.

    Only pixels count whose number in `guide` (H, W) is the place's number in `names` (N,), see `_names`. Without such a
    pixel nearby the result is `neutral` (C,). With `stops`, the brightness of the pixels (P,) and of the places (N,),
    only pixels about as bright as the place count, so that fields of a highlight stay in the highlight.
    """
    height, width = guide.shape
    # Pixels whose neighbors show something else weigh little.
    wide = torch.cat((guide, -guide)).view(2, height, width).double()
    high, low = max_pool2d(wide[None], 3, 1, 1)[0]
    flat, inner = guide.flatten(), torch.where(high == -low, 1.0, _OUTLINE).float().flatten()
    rows = fields.T.contiguous()  # the fields of a pixel are contiguous
    total = torch.zeros((place.shape[1], len(fields)), device=fields.device)
    weights = torch.zeros_like(total[:, 0])
    place = torch.nan_to_num(place, nan=-1e6).clamp(-1e6, 1e6)
    start = (place - 0.5 - _REACH).ceil().long()
    steps = torch.arange(int(2 * _REACH) + 1, device=fields.device)
    for dy in steps:
        x, y = start[0] + steps[:, None], (start[1] + dy).expand(len(steps), -1)
        inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
        index = x.clamp(0, width - 1) + width * y.clamp(0, height - 1)
        near = ((_REACH - (p + 0.5 - at).abs()).clamp_min(0.0) for p, at in zip((x, y), place, strict=True))
        weight = next(near) * next(near) * inner[index] * (inside & (flat[index] == names))
        if stops is not None:
            weight = weight * torch.exp(-(((stops[0][index] - stops[1]) / _ALIKE) ** 2))
        total += embedding_bag(index.T, rows, per_sample_weights=weight.T, mode="sum")
        weights += weight.sum(0)
    covered = weights > _LEAST_WEIGHT
    return torch.where(covered, total.T / torch.where(covered, weights, 1.0), neutral[:, None])


def is_of_light(key: str, scene: SceneData) -> bool:
    """True if a parameter only scales the color of a light or of the world: a power, color, temperature or tint."""
    group, _, name = split_key(key)
    if group == "light":
        return name in ("power", "strength", "color", "temperature")
    # A backdrop with its own color and strength does not change with the world's.
    return group == "world" and name in ("strength", "color", "tint") and not has_own_backdrop(scene)


@dataclass(frozen=True)
class CyclesPicture:
    """A Cycles render, and its parts: the image of each light alone."""

    whole: Tensor  # (H, W, 3) linear Rec.709, finite, at least 0
    parts: Tensors  # owner, "light/NAME" or "world" -> noisy image (H, W, 3) of its light alone
    rest: Tensor  # (H, W, 3) noisy image of the light that is in no part
    denoised: bool = True  # whether the whole is free of noise

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.whole.shape[1], self.whole.shape[0]

    @staticmethod
    def load(path: Path | str, groups: Mapping[str, str]) -> CyclesPicture:
        """Reads Blender's EXR file; `groups`: its light group -> owner. Raises VibeError if a layer is missing."""
        import OpenEXR

        owners = {f"Combined_{group}": owner for group, owner in groups.items()}
        try:
            # Blender 4 writes all passes into one part of the file, Blender 5 one part each.
            with OpenEXR.File(str(path)) as file:
                channels = [pair for part in file.parts for pair in part.channels.items()]
                passes = {name.partition(".")[2]: np.array(c.pixels, np.float32) for name, c in channels}
            passes = {name: p[..., :3] for name, p in passes.items() if p.ndim == 3 and p.shape[2] >= 3}
            if missing := sorted({"Combined", *owners} - passes.keys()):
                raise ValueError(f"it has no layer {missing[0]!r}")
        except (OSError, RuntimeError, ValueError, TypeError) as error:
            raise VibeError(f"Cycles' picture cannot be read: {error}.", "Try again.") from error
        raw = "Noisy Image" if "Noisy Image" in passes else "Combined"  # some builds of Blender have no denoiser
        pictures = {}
        for name in ("Combined", raw, *owners):
            picture = np.nan_to_num(passes[name], nan=0.0, posinf=_BRIGHTEST, neginf=0.0).clip(0.0, _BRIGHTEST)
            pictures[name] = torch.from_numpy(np.ascontiguousarray(picture))
        parts = {owner: pictures[name] for name, owner in owners.items()}
        rest = pictures[raw] - sum(parts.values(), torch.zeros_like(pictures[raw]))
        rest = torch.where(rest > _ROUNDING * pictures[raw], rest, torch.zeros_like(rest))
        return CyclesPicture(pictures["Combined"], parts, rest, raw != "Combined")
