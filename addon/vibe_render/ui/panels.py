# SPDX-License-Identifier: GPL-3.0-or-later
"""The main panel, the order of all panels in the tab "Vibe", and handlers of opened, saved or changed files."""

from __future__ import annotations

from types import ModuleType

import bpy
from bpy.app.handlers import persistent

from ..core import preferences
from ..run import preview
from ..run.state import addon_state
from . import drawing, light_mix, live, picture, presets, properties, result, run, scope, setup, steps, words
from .engine_state import engine_state


class MainPanel:
    """The prompt and the button Vibe It; while a vibe runs, its progress; afterwards its failure, if any."""

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        if addon_state.running and addon_state.session:  # text instead of grayed-out fields
            drawing.paragraph(layout, context, addon_state.session.wanted)
            run.draw(layout, context, addon_state.session)
            return
        # The prompt, its words, and their look so far.
        column = layout.column()
        field = column.row(align=True)
        field.scale_y = 1.3
        field.prop(settings, "prompt", text="", placeholder="misty, cool blue fog, vignette")
        field.menu("VIBE_MT_history", text="", icon="RECOVER_LAST")
        words.draw(column, context)
        if addon_state.live and addon_state.live.scene == context.scene.name:
            live.draw(column, context, addon_state.live)
        picture.draw(layout, context)
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        column.prop(settings, "effort")
        for name in ("rounds", "steps", "size") if settings.effort == "CUSTOM" else ():
            column.prop(settings, name)
        column.prop(settings, "variants")
        # The button, and what is in its way.
        engine_state.search(preferences.engine_choice(context))
        setup.warm_up_soon()
        button = layout.split(factor=0.72, align=True)
        button.scale_y = 1.8
        button.operator("vibe.run", icon="SHADERFX")
        button.prop(context.window_manager, "vibe_live", icon="PLAY", toggle=True)
        if addon_state.failure:
            setup.draw_failure(layout, context, addon_state.failure)
        elif engine_state.problem or engine_state.setup:
            setup.draw_no_engine(layout, context)
        elif reason := run.VIBE_OT_run.obstacle(context):
            drawing.paragraph(layout, context, reason, "INFO", faint=True)


def _panel(name: str, label: str, base: type, parent: str = "") -> type:
    names = {"bl_label": label, "bl_space_type": "VIEW_3D", "bl_region_type": "UI", "bl_category": "Vibe"}
    names |= {"__module__": __name__, "__doc__": base.__doc__ or ""}
    names |= {"bl_parent_id": f"VIBE_PT_{parent}"} if parent else {}
    return type(f"VIBE_PT_{name}", (base, bpy.types.Panel), names)


def _classes(*modules: ModuleType) -> list[type]:
    """The classes that modules define for Blender: operators and menus VIBE_…, groups of properties Vibe…."""
    own = [each for m in modules for each in vars(m).values() if getattr(each, "__module__", "") == m.__name__]
    return [each for each in own if isinstance(each, type) and each.__name__.startswith(("VIBE_", "Vibe"))]


CLASSES = [
    *_classes(setup, light_mix, properties, scope, run, live, words, picture, result, steps, presets),
    _panel("main", "Vibe Render", MainPanel),
    _panel("result", "Result", result.ResultPanel),
    _panel("mix", "Light Mix", light_mix.MixPanel),
    _panel("presets", "Presets", presets.PresetsPanel),
    _panel("scope", "Affect", scope.ScopePanel),
    _panel("values", "Individual Locks", scope.ValuesPanel, "scope"),
    _panel("advanced", "Advanced", scope.AdvancedPanel),
]  # to register, in this order, which is also that of the panels from top to bottom


@persistent
def _show_again(*_: object) -> None:
    """Hides previews after a load, save or undo; then the look of a running vibe, or of Live, is shown again."""
    preview.hide_all()
    light_mix.draw_soon()
    if addon_state.running and addon_state.session:
        addon_state.session.show_again()
    elif addon_state.live:
        addon_state.live.show_again()


@persistent
def _after_change(_scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
    # Updates of scenes alone are left out: each typed character causes one; see `scene_settings`.
    if not all(isinstance(update.id, bpy.types.Scene) for update in depsgraph.updates):
        addon_state.readings.scene_changed()
        if addon_state.live:
            addon_state.live.scene_changed()


_HANDLERS = {
    # Before another file is opened: what belongs to this one ends, such as a vibe, its images, Live.
    "load_pre": persistent(lambda *_: addon_state.leave_file()),
    "load_post": _show_again,
    "save_pre": persistent(lambda *_: preview.hide_all()),  # the file is saved with the artist's values
    "save_post": _show_again,
    "save_post_fail": _show_again,
    "undo_post": _show_again,
    "redo_post": _show_again,
    "depsgraph_update_post": _after_change,
}


def register() -> None:
    """Registers classes, properties, handlers and keys with Blender."""
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.Scene.vibe = bpy.props.PointerProperty(type=properties.VibeSettings)
    bpy.types.WindowManager.vibe_presets = bpy.props.PointerProperty(type=presets.VibePresets)
    bpy.types.WindowManager.vibe_live = bpy.props.BoolProperty(
        name="Live",
        description="Show the first look of the words so far, as a preview, whenever you pause in typing",
        update=live.switched,
        options={"SKIP_SAVE"},
    )
    bpy.types.WindowManager.vibe_values = bpy.props.PointerProperty(type=scope.VibeValues)
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)
    live.register_keys()


def unregister() -> None:
    """Inverse of `register`; ends the engine."""
    live.unregister_keys()
    drawing.end_timers()
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).remove(handler)
    addon_state.close()
    engine_state.close()
    drawing.free_icons()
    del bpy.types.Scene.vibe
    del bpy.types.WindowManager.vibe_presets
    del bpy.types.WindowManager.vibe_live
    del bpy.types.WindowManager.vibe_values
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
