# SPDX-License-Identifier: Apache-2.0
"""What a Cycles picture of some values teaches the proxy about others: the anchor of design section 3.

With the proxy's linear picture P(θ), Cycles' picture A at θ₀, and for every light g its part A_g of A, the proxy's
picture P_g(θ₀) with g alone, and the color s_g(θ) of its light,

    R(θ) = c P(θ) + Σ_g (A_g - c P_g(θ₀)) s_g(θ) / s_g(θ₀),      c ≈ A / P(θ₀), smoothed and bounded.

R(θ₀) is A whatever c is; so is every R(θ) in which only colors and powers of lights differ from θ₀, because light
adds up. Otherwise R has c times the proxy's own gradient. c and the residuals are constants to gradients.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import torch
from torch import Tensor

from .camera import View
from .cycles import CyclesPicture
from .joint import Guide, blur, look_up
from .view_cache import ViewCache

REST = "rest"
"""Owner of the light that belongs to no light: glowing surfaces, and what cannot be grouped."""
_RATIO = 4.0
_DARK = 0.02  # of the mean radiance: darker pixels are equally dark
_FAINT = 2e-3  # of the mean radiance: ratios between darker pixels say nothing
_BRIGHTER = 16.0  # a light that has become brighter than this times itself leaves its residual behind
_LEAST = 0.05  # of the corrected proxy: what residuals must leave of a pixel
_HAZY = 0.05  # of the mean: a part that the proxy takes for darker is smoothed as if even
_FAR = 1e4  # sizes of the scene
_RADIUS, _SIGMA = 2, 1.0  # pixels, of the smoothing of ratios and shares


@dataclass
class Correction:
    """The constants of one anchor.

    Attributes:
        view: The camera of the anchor.
        guide: What its pixels show.
        colors: Owner to s_g(θ₀), (3,).
        values: θ₀.
        stops: (P,) brightness of the proxy's picture at θ₀, in stops.
        fields: (3 (2 + G), P): c, the least share of P that must remain, and the residuals of the owners.
        owners: The G owners, `REST` among them.
    """

    view: View
    guide: Guide
    colors: Mapping[str, Tensor]
    values: Mapping[str, Tensor]
    stops: Tensor
    fields: Tensor
    owners: tuple[str, ...]
    _kept: tuple[tuple[float, ...], Tensor] | None = field(default=None, repr=False)

    @staticmethod
    def of(
        picture: CyclesPicture,
        whole: Tensor,
        parts: Mapping[str, Tensor],
        colors: Mapping[str, Tensor],
        values: Mapping[str, Tensor],
        view: View,
        cache: ViewCache,
    ) -> Correction:
        """Compares a picture with the proxy's of the same values and size.

        Args:
            picture: Cycles'.
            whole: (3, P) the proxy's.
            parts: Owner to the proxy's picture (3, P) of its light alone.
            colors: Owner to the color (3,) of its light.
            values: What the proxy was given.
            view: The camera.
            cache: What it sees.
        """
        guide = Guide(_names(cache).view(cache.depth.shape))
        known = [owner for owner in picture.parts if owner in parts]
        seen = _flat(picture.whole).to(whole)
        if not picture.denoised:
            seen = _calmed(seen, whole, guide)
        ratio = _ratio(seen, whole, guide)
        alone = [parts[owner] for owner in known]
        proxy = torch.stack([*alone, whole - sum(alone, torch.zeros_like(whole))])  # (G, 3, P)
        residuals = _shares(picture, known, proxy, guide) * seen - ratio * proxy
        tiny = 1e-6 + _FAINT * seen.mean()
        least = torch.minimum(_LEAST * ratio, seen / whole.clamp_min(tiny))
        fields = torch.cat((ratio, least, residuals.flatten(0, 1)))
        values = {key: value.detach() for key, value in values.items()}
        return Correction(view.detached(), guide, colors, values, stops(whole), fields, (*known, REST))

    def apply(
        self,
        linear: Tensor,
        colors: Mapping[str, Tensor],
        view: View,
        cache: ViewCache,
        before: Callable[[], Tensor],
    ) -> Tensor:
        """The corrected picture.

        Args:
            linear: (3, P) the proxy's; gradients pass.
            colors: Owner to the color (3,) of its light now; gradients pass.
            view: The camera now.
            cache: What it sees.
            before: Makes the proxy's picture (3, P) of θ₀ from this camera.
        """
        fields = self._at(view, cache, before)
        ratio, least = fields[:3], fields[3:6]
        corrected = ratio * linear
        for i, owner in enumerate(self.owners):
            corrected = corrected + fields[6 + 3 * i : 9 + 3 * i] * self._growth(owner, colors)
        return torch.maximum(corrected, least * linear)

    def _growth(self, owner: str, colors: Mapping[str, Tensor]) -> Tensor | float:
        """s_g(θ) / s_g(θ₀) (3, 1); a light that was off has no residual to scale."""
        before, now = self.colors.get(owner), colors.get(owner)
        if before is None or now is None:
            return 1.0
        off = before < 1e-9
        growth = torch.where(off, torch.zeros_like(now), now / torch.where(off, 1.0, before))
        return growth.clamp_max(_BRIGHTER)[:, None]

    def _at(self, view: View, cache: ViewCache, before: Callable[[], Tensor]) -> Tensor:
        """The fields for a view's pixels: as they are, or looked up where the pixels' centers were seen."""
        signature = view.signature()
        if signature == self.view.signature():
            return self.fields
        if self._kept is None or self._kept[0] != signature:
            with torch.no_grad():
                neutral = torch.zeros(len(self.fields), device=self.fields.device)
                neutral[:3] = 1.0
                place = self.view.project(_centers(view.detached(), cache))
                bright = None if view.moving else (self.stops, stops(before()))
                found = look_up(self.fields, self.guide, place, _names(cache), neutral, bright)
            self._kept = signature, found
        return self._kept[1]


def stops(picture: Tensor) -> Tensor:
    """Brightness (P,) of a linear picture (3, P) on a logarithmic scale; what is nearly black is equally so."""
    brightness = picture.clamp_min(0.0).mean(0)
    return torch.log2(brightness + 1e-6 + _DARK * brightness.mean())


def _names(cache: ViewCache) -> Tensor:
    """(P,) what the rays through the pixels' centers meet: a number for object and material, -1 for nothing."""
    hits, geometry = cache.samples.center_hits, cache.geometry
    index = hits.triangle.clamp_min(0)
    return torch.where(hits.hit, geometry.object[index] * 4096 + geometry.material[index], -1)


def _centers(view: View, cache: ViewCache) -> Tensor:
    """Points (3, P) that the rays through the pixels' centers meet; very far ones where they meet nothing."""
    width, height = view.size
    y, x = torch.meshgrid(torch.arange(height), torch.arange(width), indexing="ij")
    origin, toward = view.rays(torch.stack((x.flatten(), y.flatten())).to(view.position) + 0.5)
    return origin + toward * cache.depth.flatten().clamp_max(_FAR * cache.geometry.size)


def _flat(picture: Tensor) -> Tensor:
    """(…, H, W, 3) to (…, 3, P)."""
    return picture.flatten(-3, -2).transpose(-1, -2)


def _ratio(seen: Tensor, whole: Tensor, guide: Guide) -> Tensor:
    """c (3, P)."""
    above, below, faint = _compared(seen, whole, guide)
    return ((above + faint) / (below + faint)).clamp(1 / _RATIO, _RATIO)


def _calmed(seen: Tensor, whole: Tensor, guide: Guide) -> Tensor:
    """A noisy picture (3, P) with the proxy's detail instead of its noise."""
    above, below, faint = _compared(seen, whole, guide)
    return (whole.clamp_min(0.0) + faint) * above / (below + faint)


def _compared(seen: Tensor, whole: Tensor, guide: Guide) -> tuple[Tensor, Tensor, Tensor]:
    """Both pictures (3, P), smoothed, and a faint radiance () below which ratios say nothing."""
    above, below = blur(torch.cat((seen, whole)), guide, _RADIUS, _SIGMA).split(3)
    return above, below.clamp_min(0.0), 1e-6 + _FAINT * seen.mean()


def _shares(picture: CyclesPicture, known: list[str], proxy: Tensor, guide: Guide) -> Tensor:
    """Shares (G, 3, P) that the known owners and the rest have in the picture; they add up to 1.

    The noisy parts are smoothed relative to the proxy's, whose shadows have sharp edges.
    """
    other = sum((p for o, p in picture.parts.items() if o not in known), picture.rest)
    noisy = _flat(torch.stack([*(picture.parts[owner] for owner in known), other])).to(proxy)
    model = proxy.clamp_min(0.0) + _HAZY * proxy.abs().mean()
    above, below = (blur(p.flatten(0, 1), guide, _RADIUS, _SIGMA) for p in (noisy, model))
    parts = model * (above / below.clamp_min(1e-20)).view_as(model)
    total = parts.sum(0)
    shares = parts / total.clamp_min(1e-20)
    shares[-1] = torch.where(total > 1e-20, shares[-1], 1.0)
    return shares
