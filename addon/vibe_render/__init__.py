# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Render: type a mood; get Blender node values that render it.

Importing this needs no Blender; registering it does.
"""


def _classes() -> tuple[type, ...]:
    from .ui import operators, panels, preferences, properties, value_list

    data = (preferences, properties, value_list)
    modules = (*data, *operators.MODULES, *panels.MODULES)
    return tuple(each for module in modules for each in module.CLASSES)


def register() -> None:
    """Registers everything with Blender."""
    import bpy

    from .ui import handlers
    from .ui.operators.base import VibePresets
    from .ui.properties import VibeSettings
    from .ui.value_list import VibeValues

    for each in _classes():
        bpy.utils.register_class(each)
    bpy.types.Scene.vibe = bpy.props.PointerProperty(type=VibeSettings)
    bpy.types.WindowManager.vibe_presets = bpy.props.PointerProperty(type=VibePresets)
    bpy.types.WindowManager.vibe_values = bpy.props.PointerProperty(type=VibeValues)
    handlers.register()


def unregister() -> None:
    """Inverse of `register`; ends the engine."""
    import bpy

    from .session.engine_state import engine_state
    from .session.state import addon_state
    from .ui import handlers, look_icons, picture_icons, warm_up

    warm_up.forget()
    handlers.unregister()
    addon_state.close()
    engine_state.close()
    picture_icons.free()
    look_icons.free()
    del bpy.types.Scene.vibe
    del bpy.types.WindowManager.vibe_presets
    del bpy.types.WindowManager.vibe_values
    for each in reversed(_classes()):
        bpy.utils.unregister_class(each)
