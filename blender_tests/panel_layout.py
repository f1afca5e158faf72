# SPDX-License-Identifier: GPL-3.0-or-later
"""A layout that only writes down what a panel draws."""

from types import SimpleNamespace

import bpy


class Layout:
    """As much of Blender's layout as panels use; `drawn` is what they draw, from top to bottom."""

    def __init__(self, drawn=None):
        self.drawn = [] if drawn is None else drawn

    def _part(self, *_args, **_facts):
        return Layout(self.drawn)

    row = column = box = split = grid_flow = _part

    def panel(self, name, default_closed=False):
        self.drawn.append(name)
        return Layout(self.drawn), None if default_closed else Layout(self.drawn)

    def operator(self, name, text="", **_facts):
        self.drawn.append(name)
        return type("Properties", (), {})()

    def prop(self, _owner, name, **_facts):
        self.drawn.append(name)

    def label(self, text="", **facts):
        self.drawn.append("swatch" if "icon_value" in facts else text)

    def template_icon(self, **_facts):
        self.drawn.append("image")

    def menu(self, *_args, **_facts):
        """Not part of the order."""

    separator = progress = prop_enum = popover = menu


class Context:
    """Blender's context with a region of a sidebar's width, which there is none of without a window."""

    region, space_data = SimpleNamespace(width=280), None

    @property
    def preferences(self):
        return SimpleNamespace(system=SimpleNamespace(ui_scale=1.0), addons=bpy.context.preferences.addons)

    def __getattr__(self, name):
        return getattr(bpy.context, name)


def drawn(panel):
    """What a panel draws, in its order."""
    drawing = type("Drawing", (panel,), {"layout": Layout()})()
    drawing.draw(Context())
    return drawing.layout.drawn
