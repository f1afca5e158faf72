# SPDX-License-Identifier: Apache-2.0
"""The values of one render: the caller's, and the artist's for the rest."""

from collections.abc import Callable, Hashable, Mapping
from functools import cached_property
from typing import Any, TypeVar

import torch
from torch import Tensor

from . import SceneData

T = TypeVar("T")


def needs_gradient(*tensors: Tensor) -> bool:
    """True if gradients are being recorded for any of the tensors."""
    return torch.is_grad_enabled() and any(t.requires_grad for t in tensors)


class Recent:
    """A cache of the last two results of each owner: finite differences render a point and its neighbors in turn."""

    def __init__(self) -> None:
        self._made: dict[Hashable, dict[Hashable, Any]] = {}

    def of(self, owner: Hashable, key: Hashable, make: Callable[[], T]) -> T:
        """An owner's result for a key; `make` computes it if it is not one of the last two."""
        made = self._made.setdefault(owner, {})
        thing: T = made.pop(key) if key in made else make()
        made[key] = thing  # the newest is the last
        if len(made) > 2:
            del made[next(iter(made))]
        return thing


class RenderValues:
    """Parameters by key: the caller's tensors (C,), through which gradients flow, or else the scene's values."""

    def __init__(self, scene: SceneData, values: Mapping[str, Tensor], device: str | torch.device) -> None:
        self.scene, self.given, self.device = scene, values, torch.device(device)

    def color(self, key: str, default: float = 0.0) -> Tensor:
        """A color's components (3,), float32 on the device; each is `default` if the scene has no such parameter."""
        if key not in self.given:
            return torch.tensor(self.scene.value(key, (default,) * 3), dtype=torch.float32, device=self.device)
        # Without gradients a copy, which later changes of the caller's tensor do not reach.
        value = self.given[key].to(self.device, torch.float32).reshape(-1)
        return value if needs_gradient(value) else value.detach().clone()

    def scalar(self, key: str, default: float = 0.0) -> Tensor:
        """A parameter of one component: () float32 on the device."""
        return self.color(key, default)[0]

    @cached_property
    def by_owner(self) -> dict[str, dict[str, Tensor]]:
        """The caller's values by owner, such as "material/NAME": owner -> key -> value."""
        found: dict[str, dict[str, Tensor]] = {}
        for key, value in self.given.items():
            found.setdefault(key.rpartition("/")[0], {})[key] = value
        return found

    @cached_property
    def numbers(self) -> dict[str, tuple[float, ...]]:
        """The caller's values as numbers, by key; all in one transfer, because each transfer waits for the device."""
        rows = [value.detach().reshape(-1).to(self.device) for value in self.given.values()]
        flat = iter(torch.cat(rows).tolist() if rows else ())
        return {key: tuple(next(flat) for _ in row) for key, row in zip(self.given, rows, strict=True)}

    def kept(self, made: Recent, owner: str, make: Callable[[], T], number: int = 0) -> T:
        """The result of `make` for an owner such as "material/NAME", cached in `made` unless it has gradients.

        `number` tells apart several results of one owner.
        """
        given = self.by_owner.get(owner, {})
        if needs_gradient(*given.values()):
            return make()
        return made.of((owner, number), tuple((name, self.numbers[name]) for name in given), make)
