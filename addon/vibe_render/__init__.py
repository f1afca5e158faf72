# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Render: type a mood; get Blender node values that render it.

Importing this needs no Blender; registering it does.
"""


def _classes() -> tuple[type, ...]:
    from . import operators, panels, preferences, properties

    return (*preferences.CLASSES, *properties.CLASSES, *operators.CLASSES, *panels.CLASSES)


def register() -> None:
    """Registers everything with Blender."""
    import bpy

    from .properties import VibeSettings

    for each in _classes():
        bpy.utils.register_class(each)
    bpy.types.Scene.vibe = bpy.props.PointerProperty(type=VibeSettings)


def unregister() -> None:
    """Inverse of `register`; ends the engine."""
    import bpy

    from . import preview, session

    session.desk.close()
    preview.free()
    del bpy.types.Scene.vibe
    for each in reversed(_classes()):
        bpy.utils.unregister_class(each)
