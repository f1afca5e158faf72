# SPDX-License-Identifier: Apache-2.0
"""The values of one render: the caller's, and the artist's for the rest."""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor

from . import SceneData


class RenderValues:
    """Looks parameters up by key; missing ones take the scene's value. Gradients of the caller's tensors (C,) flow."""

    def __init__(self, scene: SceneData, values: Mapping[str, Tensor], device: str | torch.device) -> None:
        self.scene = scene
        self.given = values
        self.device = torch.device(device)

    def color(self, key: str, default: float = 0.0) -> Tensor:
        """A parameter's components (C,), float32 on the device; the default for all three where the scene has none."""
        if key in self.given:
            return self.given[key].to(self.device, torch.float32).reshape(-1)
        value = self.scene.value(key, (default,) * 3)
        return torch.tensor(value, dtype=torch.float32, device=self.device)

    def scalar(self, key: str, default: float = 0.0) -> Tensor:
        """A parameter of one component: () float32 on the device."""
        if key in self.given:
            return self.given[key].to(self.device, torch.float32).reshape(-1)[0]
        return torch.tensor(self.scene.value(key, default)[0], dtype=torch.float32, device=self.device)

    def has(self, key: str) -> bool:
        """True if the scene or the caller knows the parameter."""
        return key in self.given or key in self.scene.instances


def needs_gradient(*tensors: Tensor) -> bool:
    """True if gradients are being recorded for any of these."""
    return torch.is_grad_enabled() and any(t.requires_grad for t in tensors)
