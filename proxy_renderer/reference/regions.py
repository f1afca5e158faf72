# SPDX-License-Identifier: Apache-2.0
"""Regions of a flat image, where they are clear: a subject, its surroundings, and a sky.

Objects are not recognized. A subject is what differs from the image's border and lies near its middle, as in saliency by
background priors (Wei et al. 2012, Geodesic saliency using background priors). A sky is even, light, and touches the
upper border. Without a clear subject, the image is described by places in the frame.
"""

from dataclasses import dataclass

import numpy as np
import torch
import torch.nn.functional as F
from scipy import ndimage
from scipy.cluster.vq import kmeans2
from torch import Tensor

from ..claims.claim import Claim
from ..claims.measures.picture import MeasuredPicture
from ..color.tensors import lab_from_srgb
from ..render.surface.view_cache import GBuffer
from ..schema import Values
from ..words.types import Part
from .files import small_size

SIZE = 192  # pixels of the longer side at which images are measured, about as in the search
_TRANSPARENT, _FEW = 0.5, 16  # alpha up to which a pixel does not count; pixels below which a region is not measured
_BORDER, _GROUNDS = 0.06, 5  # width of the border in shorter sides; number of colors that stand for it
_SUBJECT = (0.04, 0.5)  # least and greatest share of the image that a subject covers
_ON_BORDER = 0.22  # greatest share of the border that a subject touches
_SKY = (0.12, 0.7)  # least and greatest share of the image that a sky covers
_EVEN, _LIGHTER, _OTHER = 2.5, 8.0, 15.0
"""Of a sky: greatest slope of L* per pixel, least L* above the rest, and least Lab distance from the color at the bottom."""


@dataclass(frozen=True)
class PictureRegions:
    """A flat image, ready to be measured, with its regions."""

    picture: MeasuredPicture
    subject: bool  # whether a subject is found
    sky: bool  # whether a sky is found
    counts: Tensor  # (H, W) bool, the pixels that are not transparent

    def region(self, part: Part, box: Values = ()) -> Tensor | None:
        """(H, W) bool: opaque pixels of a part, or of a box in it (see `Claim.box`); None if they are too few."""
        where = Claim("", part, "mean", part, (), (), box=box).region(self.picture.seen)
        where = None if where is None else where & self.counts
        return where if where is not None and where.sum() >= _FEW else None


def regions_of(display: np.ndarray, alpha: np.ndarray | None = None) -> PictureRegions:
    """The regions of an sRGB image (H, W, 3) in [0, 1] with `alpha` (H, W).

    Pixels with an alpha up to one half do not count; an image with such pixels has no subject.
    """
    seen = np.ones(display.shape[:2], bool) if alpha is None else alpha > _TRANSPARENT
    cutout = not seen.all()
    if cutout:  # transparent pixels get the color of the nearest opaque one
        nearest = ndimage.distance_transform_edt(~seen, return_distances=False, return_indices=True)
        display = display[tuple(nearest)]
    planes = torch.from_numpy(np.ascontiguousarray(display)).permute(2, 0, 1)[None]
    lab = lab_from_srgb(_resized(planes, 96)[0].permute(1, 2, 0)).numpy()
    sky = _sky(lab)
    subject = np.zeros_like(sky) if cutout else _subject(lab, sky)
    shown = _resized(planes, SIZE)
    masks = torch.from_numpy(np.stack((subject, sky)).astype(np.float32))[None]
    masks = (F.interpolate(masks, shown.shape[-2:], mode="bilinear")[0] > 0.5).float()
    # A flat image knows only which pixels are subject and which are sky.
    material, blank = torch.where((masks[1] > 0.5) & (masks[0] < 0.5), -1, 0), torch.ones_like(masks[0])
    flat = GBuffer(masks[0], material, ("",), torch.zeros(*blank.shape, 3), blank, blank)
    picture = MeasuredPicture(shown[0].permute(1, 2, 0).contiguous(), flat)
    counts = _resized(torch.from_numpy(seen.astype(np.float32))[None, None], SIZE)[0, 0] > 0.5
    return PictureRegions(picture, bool(subject.any()), bool(sky.any()), counts)


def _subject(lab: np.ndarray, sky: np.ndarray) -> np.ndarray:
    """(H, W) bool: the subject; all False if none is clear. `lab` is (H, W, 3), `sky` (H, W) bool."""
    nothing = np.zeros(sky.shape, bool)
    border, width = np.ones(sky.shape, bool), max(round(_BORDER * min(sky.shape)), 1)
    border[width:-width, width:-width] = False
    grounds = np.unique(lab[border].round().astype(float), axis=0)
    if len(grounds) > 4 * _GROUNDS:
        grounds, _ = kmeans2(lab[border].astype(float), _GROUNDS, minit="++", seed=0, missing="raise")
    apart = np.linalg.norm(lab[:, :, None] - grounds, axis=-1).min(-1) * (1 - sky)
    height, width = sky.shape
    y, x = np.mgrid[:height, :width] + 0.5
    radius = np.hypot(y - height / 2, x - width / 2) / (np.hypot(height, width) / 2)
    middle = np.exp(-0.5 * (radius / 0.6) ** 2)  # weight that falls off from the middle
    salient = ndimage.gaussian_filter(apart * middle, 1.5)
    parts, count = ndimage.label(ndimage.binary_opening(salient > _otsu(salient), iterations=2))
    if not count:
        return nothing
    weights = ndimage.sum(salient, parts, range(1, count + 1))
    subject = ndimage.binary_fill_holes(parts == 1 + int(np.argmax(weights)))
    distance = np.linalg.norm(lab[subject].mean(0) - lab[~subject].mean(0))
    fits = _SUBJECT[0] < subject.mean() < _SUBJECT[1] and subject[border].mean() < _ON_BORDER
    return subject if fits and distance > 16.0 else nothing


def _sky(lab: np.ndarray) -> np.ndarray:
    """(H, W) bool: the sky of an image (H, W, 3) in Lab; all False if none is clear."""
    even = np.hypot(*np.gradient(ndimage.gaussian_filter(lab[..., 0], 0.8))) < _EVEN
    parts, _ = ndimage.label(even)
    sky = np.isin(parts, parts[0][parts[0] > 0])
    nothing = np.zeros_like(sky)
    if not _SKY[0] < sky.mean() < _SKY[1] or sky[0].mean() < 0.75 or sky[-len(sky) // 4 :].mean() > 0.15:
        return nothing
    lighter = lab[sky][:, 0].mean() - lab[~sky][:, 0].mean()
    ground = np.linalg.norm(lab[sky].mean(0) - lab[-len(lab) // 8 :].mean((0, 1)))
    return sky if lighter > _LIGHTER and ground > _OTHER else nothing


def _otsu(field: np.ndarray) -> float:
    """The threshold that best divides the values of a field into two classes (Otsu 1979)."""
    counts, edges = np.histogram(field, 64)
    middles = (edges[1:] + edges[:-1]) / 2
    below, total = counts.cumsum(), counts.sum()
    sums = (counts * middles).cumsum()
    with np.errstate(invalid="ignore", divide="ignore"):
        between = (sums[-1] * below / total - sums) ** 2 / (below * (total - below))
    return float(middles[int(np.nanargmax(between[:-1]))])


def _resized(planes: Tensor, longest: int) -> Tensor:
    """An image (1, C, H, W), reduced by averaging areas so that the longer side is at most `longest`."""
    return F.interpolate(planes, small_size(planes.shape[-2], planes.shape[-1], longest), mode="area")
