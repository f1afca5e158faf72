# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Render: type a mood; get Blender node values that render it.

Importing this needs no Blender; registering it does.
"""


def register() -> None:
    """Registers everything with Blender."""
    from .ui import panels

    panels.register()


def unregister() -> None:
    """Inverse of `register`; ends the engine."""
    from .ui import panels

    panels.unregister()
