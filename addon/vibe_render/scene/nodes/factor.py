# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Factor: an inset of computed strengths. out = Strength · Factor."""

from __future__ import annotations

from bpy.types import NodeTree

from . import owned
from .insets import Inset


def _fill_factor(tree: NodeTree) -> None:
    owned.socket(tree, "Strength", "NodeSocketFloat", 1.0)
    owned.socket(tree, "Factor", "NodeSocketFloat", 1.0, 0.0, 1000.0)
    tree.interface.new_socket("Strength", in_out="OUTPUT", socket_type="NodeSocketFloat")
    build = owned.Builder(tree)
    build.output(build.math("MULTIPLY", *build.inputs("Strength", "Factor")))


FACTOR = Inset("Vibe Factor", {"Factor": 1.0}, _fill_factor)
