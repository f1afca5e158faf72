# SPDX-License-Identifier: Apache-2.0
"""The picture tower of our own encoders, known to timm, and so to open_clip, as `vibe_resnet`.

A pooled feature forgets where things were, but "lit from the left" and "dark corners" are about
places: here the last grid of features goes whole into the projection. Plain residual blocks on a
patch stem (He et al. 2016) cost half of what open_clip's ModifiedResNet does at the same size on a CPU.
"""

from collections.abc import Callable
from typing import Any

import torch
import torch.nn.functional as F
from timm.models import register_model
from torch import Tensor, nn

PATCH = 4
_DARK = 0.03
"""Added before logarithms are taken: black noise says nothing."""
GRID = 5
"""Cells along one side of the last grid of features."""


class Block(nn.Module):
    """Two 3 × 3 convolutions and a shortcut; `stride` halves the picture."""

    def __init__(self, inputs: int, outputs: int, stride: int) -> None:
        super().__init__()
        self.first = nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False)
        self.first_norm = nn.BatchNorm2d(outputs)
        self.second = nn.Conv2d(outputs, outputs, 3, 1, 1, bias=False)
        self.second_norm = nn.BatchNorm2d(outputs)
        self.shortcut = nn.Sequential()
        if inputs != outputs:
            self.shortcut = nn.Sequential(
                nn.AvgPool2d(stride, ceil_mode=True),
                nn.Conv2d(inputs, outputs, 1, bias=False),
                nn.BatchNorm2d(outputs),
            )

    def forward(self, x: Tensor) -> Tensor:
        """(B, inputs, H, W) → (B, outputs, H / stride, W / stride)."""
        inner = F.relu(self.first_norm(self.first(x)), inplace=True)
        return F.relu(self.second_norm(self.second(inner)) + self.shortcut(x))


class Stem(nn.Module):
    """Patches, and what is inside them: one linear step cannot tell a sharp edge from a blurred one.

    Sharp edges in reflections are gloss, and in shadows hard light.
    """

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.patches = nn.Conv2d(6, outputs, PATCH, PATCH, bias=False)
        self.edges = nn.Sequential(
            nn.Conv2d(6, outputs // 2, 3, 2, 1, bias=False),
            nn.BatchNorm2d(outputs // 2),
            nn.ReLU(inplace=True),
            nn.Conv2d(outputs // 2, outputs, 3, 2, 1, bias=False),
        )

    def forward(self, x: Tensor) -> Tensor:
        """(B, 3, H, W) display values, less 0.5 and over 0.25 → (B, outputs, H / 4, W / 4)."""
        both = with_logarithm(x)
        return self.patches(both) + self.edges(both)


def with_logarithm(x: Tensor) -> Tensor:
    """A picture (B, 3, H, W) and its logarithm, as six channels.

    In the logarithm light and color add up, so that a shaded side, a cast of the light or a highlight looks alike on every color.

    Args:
        x: Display values, less 0.5 and over 0.25.
    """
    return torch.cat([x, torch.log((0.25 * x + 0.5).clamp_min(0) + _DARK) + 1], 1)


class Tower(nn.Sequential):
    """Pictures (B, 3, H, W) → features (B, features).

    Args:
        stem: Makes, for a number of channels, what turns pictures into a grid of a fourth of their size.
        strides: Of each stage; a 2 halves the grid.
    """

    def __init__(
        self,
        features: int,
        stem: Callable[[int], nn.Module],
        widths: tuple[int, ...],
        depths: tuple[int, ...],
        strides: tuple[int, ...],
    ) -> None:
        layers: list[nn.Module] = [stem(widths[0]), nn.BatchNorm2d(widths[0]), nn.ReLU(inplace=True)]
        inputs = widths[0]
        for width, depth, stride in zip(widths, depths, strides, strict=True):
            for k in range(depth):
                layers.append(Block(inputs, width, 1 if k else stride))
                inputs = width
        layers += [nn.AdaptiveAvgPool2d(GRID), nn.Flatten(), nn.Linear(inputs * GRID**2, features)]
        super().__init__(*layers)


@register_model
def vibe_resnet(pretrained: bool = False, num_classes: int = 128, **unused: Any) -> Tower:
    """What `timm_model_name: "vibe_resnet"` in an open_clip configuration builds.

    Args:
        pretrained: Has no effect: timm passes it, and there are no pretrained weights.
        num_classes: timm's name for the length of a feature.
    """
    return Tower(num_classes, Stem, (32, 64, 96, 160), (2, 2, 2, 2), (1, 2, 2, 1))
