# SPDX-License-Identifier: Apache-2.0
"""Dense labels of training pictures: a second task, which teaches faster than classes alone.

A head that says "lit from the left" has to tell shape from shadow and color from light first. The traced views know
all of that for every pixel, so the last grid of the picture tower learns to tell it too; nothing of this is exported.
"""

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from lab.train.pictures.bank import SUBJECT

GRID = 16
"""Cells along one side of the maps."""
_FINE = 40
CHANNELS = 11
"""Subject, normal as the camera sees it (3), light received, albedo (3), how clear the air is, the share of gleam, penumbra."""


def maps(view: dict[str, Tensor], look: dict[str, Tensor], gleam: Tensor) -> Tensor:
    """Labels of every part of every picture, as the last grid of the picture tower learns it.

    Args:
        view: G views as `data.gather` returns them.
        look: What `looks.parameters` returns for (G, K) looks.
        gleam: (G, K, 1, H, W), the share of gleam that `shader.shade` gives.

    Returns:
        (G, K, CHANNELS, 40, 40).
    """
    kind = view["kind"]
    count = look["metal"].shape[1]
    subject, surface = (kind == SUBJECT)[:, :, None].float(), (kind > 0)[:, :, None].float()
    normal = torch.einsum("gkji,gkjhw->gkihw", view["camera"], view["normal"])
    towards = torch.einsum("gkji,gkj->gki", view["camera"].expand(-1, count, -1, -1), view["light"])
    shadow = view["shadow"][:, :, None]
    free, penumbra = _pool(shadow * surface), _pool(4 * shadow * (1 - shadow) * surface)
    subject, surface, normal, depth = (
        _pool(field) for field in (subject, surface, normal, view["depth"][:, :, None].clamp_max(8.0))
    )
    lit = (normal * towards[..., None, None]).sum(2, keepdim=True).clamp_min(0) * free
    albedo = torch.lerp(look["surroundings"][..., None, None], look["subject"][..., None, None], subject)
    clear = torch.exp(-look["fog"][..., None, None, None] * depth)
    parts = [subject, normal, lit, albedo.clamp_min(0).sqrt(), clear, _pool(gleam), penumbra]
    return torch.cat([part.expand(-1, count, -1, -1, -1) for part in parts], 2)


def _pool(field: Tensor) -> Tensor:
    g, k = field.shape[:2]
    pooled = F.adaptive_avg_pool2d(field.flatten(0, 1), _FINE)
    return pooled.view(g, k, *pooled.shape[1:])


def framed(maps: Tensor, box: tuple[float, float, float], mirrored: bool) -> Tensor:
    """Maps (K, CHANNELS, 40, 40) of a part of the pictures, (K, CHANNELS, GRID, GRID).

    Args:
        box: Top, left and side of the part, in shares of the picture's side.
        mirrored: Whether the part is then mirrored.
    """
    top, left, side = box
    cells = (torch.arange(GRID, device=maps.device) + 0.5) / GRID
    y, x = (2 * (start + side * cells) - 1 for start in (top, left))
    grid = torch.stack(torch.meshgrid(y, x, indexing="ij")[::-1], -1).expand(len(maps), -1, -1, -1)
    part = F.grid_sample(F.avg_pool2d(maps, 3, 1, 1, count_include_pad=False), grid, align_corners=False)
    if mirrored:
        part = part.flip(-1)
        part[:, 1] *= -1
    return part


class MapReader(nn.Module):
    """Reads the maps off the grid of features that a module of the picture tower puts out.

    Args:
        module: The last module of the tower that still has a grid.
    """

    def __init__(self, module: nn.Module, channels: int) -> None:
        super().__init__()
        self.layer = nn.Conv2d(channels, 4 * CHANNELS, 1)
        self._grid: list[Tensor] = []
        module.register_forward_hook(lambda _module, _inputs, output: self._grid.__setitem__(slice(None), [output]))

    def loss(self, truth: Tensor, weight: Tensor) -> Tensor:
        """Mean share of the maps' variance (B, CHANNELS, GRID, GRID) left unexplained in the pictures seen last.

        Args:
            weight: (B, 1, GRID, GRID) how much each cell counts.
        """
        maps = F.pixel_shuffle(self.layer(self._grid.pop().float()), 2)
        size = (maps.shape[-2], maps.shape[-1])
        truth, weight = F.adaptive_avg_pool2d(truth, size), F.adaptive_avg_pool2d(weight, size)
        spread = truth.var((0, 2, 3), keepdim=True).clamp_min(1e-2)  # or light, which varies little, is never learned
        return (weight * (maps - truth) ** 2 / spread).mean() / weight.mean().clamp_min(1e-3)
