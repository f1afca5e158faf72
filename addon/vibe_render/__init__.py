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

    from .ui import handlers, live
    from .ui.operators.base import VibePresets
    from .ui.operators.live import register_keys
    from .ui.properties import VibeSettings
    from .ui.value_list import VibeValues

    for each in _classes():
        bpy.utils.register_class(each)
    bpy.types.Scene.vibe = bpy.props.PointerProperty(type=VibeSettings)
    bpy.types.WindowManager.vibe_presets = bpy.props.PointerProperty(type=VibePresets)
    bpy.types.WindowManager.vibe_live = bpy.props.BoolProperty(
        name="Live",
        description="Show the first look of the words so far, as a preview, whenever you pause in typing",
        update=live.switched,
        options={"SKIP_SAVE"},
    )
    bpy.types.WindowManager.vibe_values = bpy.props.PointerProperty(type=VibeValues)
    handlers.register()
    register_keys()


def unregister() -> None:
    """Inverse of `register`; ends the engine."""
    import bpy

    from .run.engine_state import engine_state
    from .run.state import addon_state
    from .ui import handlers, live, look_icons, picture_icons, warm_up, word_readings
    from .ui.operators.live import unregister_keys

    unregister_keys()
    warm_up.forget()
    live.stop()
    word_readings.stop()
    handlers.unregister()
    addon_state.close()
    engine_state.close()
    picture_icons.free()
    look_icons.free()
    del bpy.types.Scene.vibe
    del bpy.types.WindowManager.vibe_presets
    del bpy.types.WindowManager.vibe_live
    del bpy.types.WindowManager.vibe_values
    for each in reversed(_classes()):
        bpy.utils.unregister_class(each)
