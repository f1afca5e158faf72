# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Render: type a mood; get Blender node values that render it.

Importing this needs no Blender; registering it does.
"""


def _classes() -> tuple[type, ...]:
    from . import operators, panels, preferences, preset_operators, preset_panel, properties

    modules = (preferences, properties, operators, preset_operators, panels, preset_panel)
    return tuple(each for module in modules for each in module.CLASSES)


def register() -> None:
    """Registers everything with Blender."""
    import bpy

    from .preset_operators import VibePresets
    from .properties import VibeSettings

    for each in _classes():
        bpy.utils.register_class(each)
    bpy.types.Scene.vibe = bpy.props.PointerProperty(type=VibeSettings)
    bpy.types.WindowManager.vibe_presets = bpy.props.PointerProperty(type=VibePresets)


def unregister() -> None:
    """Inverse of `register`; ends the engine."""
    import bpy

    from . import preset_pictures, preview, session

    session.desk.close()
    preview.free()
    preset_pictures.free()
    del bpy.types.Scene.vibe
    del bpy.types.WindowManager.vibe_presets
    for each in reversed(_classes()):
        bpy.utils.unregister_class(each)
