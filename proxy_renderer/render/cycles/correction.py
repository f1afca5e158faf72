# SPDX-License-Identifier: Apache-2.0
"""The anchor: a correction of the proxy by a Cycles picture of known values.

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

from ..geometry.camera import View
from ..geometry.samples import Samples
from ..geometry.visibility import Hits, RayGeometry
from ..surface.view_cache import ViewCache
from .joint_bilateral import GuideImage, blur, look_up
from .pictures import CyclesPicture

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
        dark: Radiance below which all is equally dark.
        stops: (P,) brightness of the proxy's picture at θ₀, in stops.
        fields: (3 (2 + G), P): c, the least share of P that must remain, and the residuals of the owners.
        owners: The G owners, `REST` among them.
    """

    view: View
    guide: GuideImage
    colors: Mapping[str, Tensor]
    values: Mapping[str, Tensor]
    dark: float
    stops: Tensor
    fields: Tensor
    owners: tuple[str, ...]
    _kept: tuple[ViewCache, Tensor] | None = field(default=None, repr=False)

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
            whole: (3, P) the proxy's.
            parts: Owner to the proxy's picture (3, P) of its light alone.
            colors: Owner to the color (3,) of its light.
        """
        guide = GuideImage(_names(cache.samples.center_hits, cache.geometry).view(cache.depth.shape))
        shared_owners = [owner for owner in picture.parts if owner in parts]
        reference = _flat(picture.whole).to(whole)
        if not picture.denoised:
            reference = _calmed(reference, whole, guide)
        ratio = _ratio(reference, whole, guide)
        alone = [parts[owner] for owner in shared_owners]
        proxy = torch.stack([*alone, whole - sum(alone, torch.zeros_like(whole))])  # (G, 3, P)
        residuals = _shares(picture, shared_owners, proxy, guide) * reference - ratio * proxy
        tiny = 1e-6 + _FAINT * reference.mean()
        least = torch.minimum(_LEAST * ratio, reference / whole.clamp_min(tiny))
        fields = torch.cat((ratio, least, residuals.flatten(0, 1)))
        values = {key: value.detach() for key, value in values.items()}
        dark = 1e-6 + _DARK * float(whole.mean())
        kept = view.detached(), guide, colors, values, dark, _stops(whole, dark)
        return Correction(*kept, fields, (*shared_owners, REST))

    def fits(self, view: View) -> bool:
        """Whether a view's pixels are those of the anchor."""
        return view.signature() == self.view.signature()

    def pixels(self, linear: Tensor, colors: Mapping[str, Tensor]) -> Tensor:
        """Corrected pixels of a view that fits.

        Args:
            linear: (3, P) the proxy's; gradients pass.
            colors: Owner to the color (3,) of its light now; gradients pass.
        """
        return self._apply(linear, colors, self.fields)

    def samples(
        self,
        radiance: Tensor,
        colors: Mapping[str, Tensor],
        view: View,
        cache: ViewCache,
        before: Callable[[], Tensor],
    ) -> Tensor:
        """Corrected samples of another view: sample by sample, so that outlines stay smooth.

        Args:
            radiance: (3, N) the proxy's; gradients pass.
            colors: As for `pixels`.
            before: Makes the proxy's samples (3, N) of θ₀ for this camera.
        """
        if self._kept is None or self._kept[0] is not cache:
            with torch.no_grad():
                self._kept = cache, self._look_up(cache.samples, cache.geometry, view, before)
        return self._apply(radiance, colors, self._kept[1])

    def _apply(self, linear: Tensor, colors: Mapping[str, Tensor], fields: Tensor) -> Tensor:
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

    def _look_up(
        self, samples: Samples, geometry: RayGeometry, view: View, before: Callable[[], Tensor]
    ) -> Tensor:
        """The fields where the anchor saw what samples meet; neutral ones where it did not."""
        neutral = torch.zeros(len(self.fields), device=self.fields.device)
        neutral[:3] = 1.0
        reach = samples.hits.distance.clamp_max(_FAR * geometry.size)
        place = self.view.project(samples.origin + samples.toward * reach)
        bright = None if view.moving else (self.stops, _stops(before(), self.dark))
        return look_up(self.fields, self.guide, place, _names(samples.hits, geometry), neutral, bright)


def _stops(linear: Tensor, dark: float) -> Tensor:
    """Brightness (N,) of linear colors (3, N) on a logarithmic scale."""
    return torch.log2(linear.clamp_min(0.0).mean(0) + dark)


def _names(hits: Hits, geometry: RayGeometry) -> Tensor:
    """(N,) what rays meet: a number for object and material, -1 for nothing."""
    index = hits.triangle.clamp_min(0)
    return torch.where(hits.hit, geometry.object[index] * 4096 + geometry.material[index], -1)


def _flat(picture: Tensor) -> Tensor:
    """(…, H, W, 3) to (…, 3, P)."""
    return picture.flatten(-3, -2).transpose(-1, -2)


def _ratio(reference: Tensor, whole: Tensor, guide: GuideImage) -> Tensor:
    """c (3, P)."""
    above, below, faint = _compared(reference, whole, guide)
    return ((above + faint) / (below + faint)).clamp(1 / _RATIO, _RATIO)


def _calmed(reference: Tensor, whole: Tensor, guide: GuideImage) -> Tensor:
    """A noisy picture (3, P) with the proxy's detail instead of its noise."""
    above, below, faint = _compared(reference, whole, guide)
    return (whole.clamp_min(0.0) + faint) * above / (below + faint)


def _compared(reference: Tensor, whole: Tensor, guide: GuideImage) -> tuple[Tensor, Tensor, Tensor]:
    """Both pictures (3, P), smoothed, and a faint radiance () below which ratios say nothing."""
    above, below = blur(torch.cat((reference, whole)), guide, _RADIUS, _SIGMA).split(3)
    return above, below.clamp_min(0.0), 1e-6 + _FAINT * reference.mean()


def _shares(picture: CyclesPicture, shared_owners: list[str], proxy: Tensor, guide: GuideImage) -> Tensor:
    """Shares (G, 3, P) that the known owners and the rest have in the picture; they add up to 1.

    The noisy parts are smoothed relative to the proxy's, whose shadows have sharp edges.
    """
    other = sum((p for o, p in picture.parts.items() if o not in shared_owners), picture.rest)
    noisy = _flat(torch.stack([*(picture.parts[owner] for owner in shared_owners), other])).to(proxy)
    model = proxy.clamp_min(0.0) + _HAZY * proxy.abs().mean()
    above, below = (blur(p.flatten(0, 1), guide, _RADIUS, _SIGMA) for p in (noisy, model))
    parts = model * (above / below.clamp_min(1e-20)).view_as(model)
    total = parts.sum(0)
    shares = parts / total.clamp_min(1e-20)
    shares[-1] = torch.where(total > 1e-20, shares[-1], 1.0)
    return shares
