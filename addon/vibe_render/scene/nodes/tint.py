# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Tint: an inset of computed colors. out = Tint · lerp(Color, luma(Color), Recolor), luma with the weights of Rec.709."""

from __future__ import annotations

from bpy.types import NodeTree

from ...core.color import LUMA
from . import owned
from .insets import Inset


def _fill_tint(tree: NodeTree) -> None:
    owned.socket(tree, "Color", "NodeSocketColor", (0.8, 0.8, 0.8, 1.0))
    owned.socket(tree, "Tint", "NodeSocketColor", (1.0, 1.0, 1.0, 1.0))
    owned.socket(tree, "Recolor", "NodeSocketFloat", 0.0, 0.0, 1.0)
    tree.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    build = owned.Builder(tree)
    color, tint, recolor = build.inputs("Color", "Tint", "Recolor")
    luma = build.vector("DOT_PRODUCT", color, LUMA)
    gray = build.vector("SCALE", build.vector("SUBTRACT", luma, color), scale=recolor)
    build.output(build.vector("MULTIPLY", build.vector("ADD", color, gray), tint))


TINT = Inset("Vibe Tint", {"Tint": (1.0, 1.0, 1.0), "Recolor": 0.0}, _fill_tint)
