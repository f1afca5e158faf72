# SPDX-License-Identifier: Apache-2.0
"""The values of one render: the caller's, and the artist's for the rest."""

from collections.abc import Callable, Hashable, Mapping
from functools import cached_property
from typing import Any, TypeVar

import torch
from torch import Tensor

from . import SceneData

T = TypeVar("T")


class RenderValues:
    """Looks parameters up by key; missing ones take the scene's value. Gradients of the caller's tensors (C,) flow."""

    def __init__(self, scene: SceneData, values: Mapping[str, Tensor], device: str | torch.device) -> None:
        self.scene = scene
        self.given = values
        self.device = torch.device(device)

    def color(self, key: str, default: float = 0.0) -> Tensor:
        """A parameter's components (C,), float32 on the device; the default for all three where the scene has none."""
        if key in self.given:
            return self._read(key)
        value = self.scene.value(key, (default,) * 3)
        return torch.tensor(value, dtype=torch.float32, device=self.device)

    def _read(self, key: str) -> Tensor:
        """The caller's value (C,); a copy, which stays what it is, unless gradients go to it."""
        value = self.given[key].to(self.device, torch.float32).reshape(-1)
        return value if needs_gradient(value) else value.detach().clone()

    def scalar(self, key: str, default: float = 0.0) -> Tensor:
        """A parameter of one component: () float32 on the device."""
        if key in self.given:
            return self._read(key)[0]
        return torch.tensor(self.scene.value(key, default)[0], dtype=torch.float32, device=self.device)

    @cached_property
    def by_owner(self) -> dict[str, dict[str, Tensor]]:
        """The caller's values: "material/NAME" and so on -> key -> value."""
        found: dict[str, dict[str, Tensor]] = {}
        for key, value in self.given.items():
            found.setdefault(key.rpartition("/")[0], {})[key] = value
        return found

    @cached_property
    def numbers(self) -> dict[str, tuple[float, ...]]:
        """The caller's values as numbers, by key; read from the device at once, because each reading waits for it."""
        rows = [value.detach().reshape(-1).to(self.device) for value in self.given.values()]
        flat = iter(torch.cat(rows).tolist() if rows else ())
        return {key: tuple(next(flat) for _ in row) for key, row in zip(self.given, rows, strict=True)}

    def has(self, key: str) -> bool:
        """True if the scene or the caller knows the parameter."""
        return key in self.given or key in self.scene.instances


def needs_gradient(*tensors: Tensor) -> bool:
    """True if gradients are being recorded for any of these."""
    return torch.is_grad_enabled() and any(t.requires_grad for t in tensors)


class Recent:
    """The last two things of each owner: at a point, and next to it. Renders for slopes differ in one value each."""

    def __init__(self) -> None:
        self._made: dict[Hashable, dict[Hashable, Any]] = {}

    def of(self, owner: Hashable, key: Hashable, make: Callable[[], T]) -> T:
        """The thing of an owner for a key; `make` makes it if it is none of the last two."""
        made = self._made.setdefault(owner, {})
        thing: T = made.pop(key) if key in made else make()
        made[key] = thing  # the newest is the last
        if len(made) > 2:
            del made[next(iter(made))]
        return thing


class Remembered:
    """Things that are made of the values of one owner, a light or a material: the same thing again for the same values.

    What is learned is made anew.
    """

    def __init__(self) -> None:
        self._recent = Recent()

    def of(self, owner: str, values: RenderValues, make: Callable[[], T], number: int = 0) -> T:
        """The thing of an owner, "material/NAME", by its number where several have one name; `make` makes it of these values."""
        given = values.by_owner.get(owner, {})
        if needs_gradient(*given.values()):
            return make()
        key = tuple((name, values.numbers[name]) for name in given)
        return self._recent.of((owner, number), key, make)
