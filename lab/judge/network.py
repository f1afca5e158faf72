# SPDX-License-Identifier: Apache-2.0
"""The picture tower of the judge, known to timm as `vibe_resnet_judge`: other proportions than the embedded encoder's."""

from typing import Any

from timm.models import register_model
from torch import Tensor, nn

from proxy_renderer.guidance.encoder import PATCH, Tower, with_logarithm


class Patches(nn.Conv2d):
    """A convolution of patches of a picture and of its logarithm.

    In the logarithm light and color add up, so that a shaded side, a cast of the light or a highlight looks alike
    on every color.
    """

    def __init__(self, outputs: int) -> None:
        super().__init__(6, outputs, PATCH, PATCH, bias=False)

    def forward(self, x: Tensor) -> Tensor:
        """(B, 3, H, W) display values, less 0.5 and over 0.25 → (B, outputs, H / 4, W / 4)."""
        return super().forward(with_logarithm(x))


@register_model
def vibe_resnet_judge(pretrained: bool = False, num_classes: int = 192, **unused: Any) -> Tower:
    """A tower of other proportions, which sees patches alone, for an encoder that judges results and never guides.

    Args:
        pretrained: As for `vibe_resnet`.
        num_classes: As for `vibe_resnet`.
        **unused: As for `vibe_resnet`.
    """
    return Tower(num_classes, Patches, (32, 64, 128, 256), (1, 1, 1, 1), (1, 2, 2, 2))
