# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Render: type a mood; get Blender node values that render it.

Importing this needs no Blender; registering it does.
"""


def _classes() -> tuple[type, ...]:
    from . import (
        engine_operators,
        look_operators,
        operators,
        panels,
        preferences,
        preset_operators,
        preset_panel,
        properties,
        result_operators,
        small_operators,
        value_list,
    )

    data = (preferences, properties, value_list)
    actions = (
        engine_operators,
        operators,
        small_operators,
        result_operators,
        preset_operators,
        look_operators,
    )
    modules = (*data, *actions, panels, preset_panel)
    return tuple(each for module in modules for each in module.CLASSES)


def register() -> None:
    """Registers everything with Blender."""
    import bpy

    from . import handlers
    from .preset_actions import VibePresets
    from .properties import VibeSettings
    from .value_list import VibeValues

    for each in _classes():
        bpy.utils.register_class(each)
    bpy.types.Scene.vibe = bpy.props.PointerProperty(type=VibeSettings)
    bpy.types.WindowManager.vibe_presets = bpy.props.PointerProperty(type=VibePresets)
    bpy.types.WindowManager.vibe_values = bpy.props.PointerProperty(type=VibeValues)
    handlers.register()


def unregister() -> None:
    """Inverse of `register`; ends the engine."""
    import bpy

    from . import engine_place, handlers, preset_pictures, preview
    from .desk import desk

    handlers.unregister()
    desk.close()
    engine_place.place.close()
    preview.free()
    preset_pictures.free()
    del bpy.types.Scene.vibe
    del bpy.types.WindowManager.vibe_presets
    del bpy.types.WindowManager.vibe_values
    for each in reversed(_classes()):
        bpy.utils.unregister_class(each)
