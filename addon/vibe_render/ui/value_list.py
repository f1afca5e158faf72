# SPDX-License-Identifier: GPL-3.0-or-later
# mypy: disable-error-code="valid-type"
"""The list of all single values of the scene, each with a lock; filled again when things are added or removed."""

from __future__ import annotations

from typing import Any, ClassVar

import bpy
from bpy.props import CollectionProperty, IntProperty, StringProperty

from ..core import drawing
from ..core.schema_import import labels, schema
from ..scene import bindings, scene_context


class VibeValue(bpy.types.PropertyGroup):
    """A value of the scene. Its `name` is the parameter's key."""

    title: StringProperty()
    reason: StringProperty(description="Why it must be left alone; empty where it may change")


class VibeValues(bpy.types.PropertyGroup):
    """The rows of the list; they belong to the window, not to the file."""

    rows: CollectionProperty(type=VibeValue)
    active: IntProperty(options={"SKIP_SAVE"})


class VIBE_UL_values(bpy.types.UIList):
    """One value and its lock on each line."""

    def draw_item(
        self,
        context: bpy.types.Context,
        layout: bpy.types.UILayout,
        _data: Any,
        item: VibeValue,
        _icon: int,
        _active_data: Any,
        _active: str,
        _index: int = 0,
        _flag: int = 0,
    ) -> None:
        """Draws a line: group, whose value, lock."""
        settings = context.scene.vibe
        group = schema.split_key(item.name)[0]
        reason = item.reason
        if not getattr(settings, f"change_{group}"):
            reason = f"the group {labels.GROUP_TITLES[group]} is locked"
        row = layout.row(align=True)
        names = row.row()
        names.active = not reason
        names.label(text=item.title, icon=drawing.GROUP_ICONS[group])
        draw_lock(row, settings, item.name, reason)

    def filter_items(
        self, _context: bpy.types.Context, data: VibeValues, _name: str
    ) -> tuple[list[int], list[int]]:
        """Lines with the letters of the search field in their title or key."""
        words = self.filter_name.casefold().split()
        shown = [all(w in f"{r.title} {r.name}".casefold() for w in words) for r in data.rows]
        return [self.bitflag_filter_item if show else 0 for show in shown], []


def draw_lock(layout: bpy.types.UILayout, settings: Any, key: str, reason: str = "") -> None:
    """Draws the lock of a value.

    Args:
        settings: The scene's `VibeSettings`.
        reason: Why the value must stay anyway: the lock is closed then, with the reason as its tool tip.
    """
    locked = key in settings.locks
    row = layout.row()
    row.enabled = not reason
    icon = "LOCKED" if locked or reason else "UNLOCKED"
    button = row.operator("vibe.lock", text="", icon=icon, emboss=False)
    button.key, button.reason = key, reason


class VIBE_OT_lock(bpy.types.Operator):
    """Keep a single value as it is, or set it free"""

    bl_idname = "vibe.lock"
    bl_label = "Lock"
    bl_options: ClassVar[set[str]] = {"UNDO", "INTERNAL"}

    key: StringProperty()
    reason: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        """What a click does, or why it does nothing."""
        if properties.reason:
            return f"Stays as it is: {properties.reason}"
        locked = properties.key in context.scene.vibe.locks
        title = labels.title(properties.key)
        return f"Let a vibe change {title}" if locked else f"Keep {title} as it is"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Turns the lock."""
        locks = context.scene.vibe.locks
        place = locks.find(self.key)
        if place >= 0:
            locks.remove(place)
        else:
            locks.add().name = self.key
        return {"FINISHED"}


class VIBE_OT_unlock_all(bpy.types.Operator):
    """Open the locks of all single values"""

    bl_idname = "vibe.unlock_all"
    bl_label = "Unlock All"
    bl_options: ClassVar[set[str]] = {"UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Only when there are locks."""
        cls.poll_message_set("No single value is locked")
        return bool(context.scene.vibe.locks)

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Opens them."""
        context.scene.vibe.locks.clear()
        return {"FINISHED"}


_listed: tuple = ()  # fingerprint of the scene that the list shows
_wanted: tuple = ()  # fingerprint of the scene that a timer is going to list


def keep_up(context: bpy.types.Context) -> None:
    """Fills the list by a timer if the scene has changed: a panel that draws must not change anything."""
    global _wanted
    now = _fingerprint(context.scene)
    if now not in (_listed, _wanted):
        _wanted = now
        bpy.app.timers.register(lambda: _soon(now[0]), first_interval=0.01)


def _fingerprint(scene: bpy.types.Scene) -> tuple:
    counted = (scene.objects, bpy.data.materials, bpy.data.lights)
    return scene.session_uid, *map(len, counted), bool(scene.world), len(scene.vibe.changes)


def _soon(uid: int) -> None:
    scene = next((s for s in bpy.data.scenes if s.session_uid == uid), None)
    if scene is not None:
        fill(scene)
        drawing.redraw()


def fill(scene: bpy.types.Scene) -> None:
    """Lists the scene's values."""
    global _listed, _wanted
    _listed, _wanted = _fingerprint(scene), ()
    rows = bpy.context.window_manager.vibe_values.rows
    rows.clear()
    for instance in bindings.instances(scene, scene_context.meshes(scene), scene.vibe.pivot).values():
        row = rows.add()
        row.name, row.title = instance.key, labels.title(instance.key)
        row.reason = instance.locked


CLASSES = (VibeValue, VibeValues, VIBE_UL_values, VIBE_OT_lock, VIBE_OT_unlock_all)
