# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Render: type a mood; get Blender node values that render it.

Importing this package needs no Blender; `register` does.
"""


def register() -> None:
    """Registers the add-on's classes, properties, handlers and keys with Blender."""
    from .ui import panels

    panels.register()


def unregister() -> None:
    """Undoes `register`, and ends the engine's process."""
    from .ui import panels

    panels.unregister()
