# SPDX-License-Identifier: GPL-3.0-or-later
"""A glossy shader that a Fresnel or Layer Weight node lays over another one: the lacquer of car paints made of nodes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from bpy.types import Material

from ...core.journal import Journal
from ...core.value_slots import ValueSlot, same
from . import inputs, layers
from .layers import Layer
from .trails import NodeEntry


@dataclass
class StrengthSlot:
    """Value slot: the strongest component of a color; setting it keeps the hue.

    Attributes:
        color: The slot of the color, RGB or RGBA.
    """

    color: ValueSlot

    @property
    def locked(self) -> str:
        """Why it must be left alone; "" where it may change."""
        return self.color.locked

    def get(self) -> float:
        """From 0 to 1."""
        return float(min(max(self.color.get()[:3]), 1.0))

    def set(self, journal: Journal, raw: float) -> None:
        """Makes the color as strong as that."""
        color, strongest = self.color.get(), max(self.color.get()[:3])
        if same(raw, self.get()):
            return
        self.color.set(journal, tuple(raw * c / strongest if strongest else raw for c in color[:3]))


def glossy_layer(every: list[Layer], base: Layer) -> Layer | None:
    """The glossy shader that is mixed with another one.

    Args:
        every: The shaders of a material, in the order of the mixes.
        base: The one that has the color.
    """
    return next((x for x in every if x.matter == "metal" and x != base and x.sides), None)


def lacquer_over(every: list[Layer], base: Layer) -> Layer | None:
    """The lacquer over a metal; None over anything else.

    Args:
        every: The shaders of a material, in the order of the mixes.
        base: The one that has the color.
    """
    over = glossy_layer(every, base) if base.matter == "metal" else None
    return over if over and over.sides[-1].grazing else None


def lacquer_weight(material: Material) -> ValueSlot | None:
    """How strong the lacquer over a metal is: its color, which is 1 at full strength; None without one."""
    color = inputs.slot(partial(_lacquer_entry, material, "Base Color"))
    return StrengthSlot(color) if color else None


def lacquer_roughness(material: Material) -> ValueSlot | None:
    """The roughness of the lacquer over a metal; None without one."""
    return inputs.slot(partial(_lacquer_entry, material, "Roughness"))


def _lacquer_entry(material: Material, name: str) -> NodeEntry | None:
    body = layers.body(material)
    coat = lacquer_over(layers.layers(material), body[0]) if body else None
    return coat.shader.entry(name) if coat else None
