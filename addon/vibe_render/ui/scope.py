# SPDX-License-Identifier: GPL-3.0-or-later
"""The limits of a vibe: panels of the groups and the subject, of single values with locks, of advanced settings."""

from __future__ import annotations

from typing import Any

import bpy
from bpy.props import CollectionProperty, IntProperty, StringProperty

from ..core.schema_import import labels, schema
from ..scene import bindings, scene_context
from . import drawing
from .bases import IdlePanel, Operator

_listed: tuple = ()  # fingerprint of the scene that the list shows, or that a timer is going to list


class ScopePanel(IdlePanel):
    """The groups that may change, and the subject."""

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        grid = layout.grid_flow(columns=2, even_columns=True)
        for group in schema.GROUPS:
            grid.prop(settings, f"change_{group}")
        column = layout.column()
        column.use_property_split, column.use_property_decorate = True, False
        column.prop(settings, "subject")
        if settings.subject == "COLLECTION":
            column.prop(settings, "collection", text=" ")
        column.prop(settings, "shared", text="Shared Materials")
        column.prop(settings, "new_lights")
        column.prop(settings, "offset_keys")


class ValuesPanel(IdlePanel):
    """Every single value of the scene, with a lock."""

    def draw_header_preset(self, context: bpy.types.Context) -> None:
        if count := len(context.scene.vibe.locks):
            self.layout.label(text=f"{count} locked ")  # type: ignore[attr-defined]

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the list, which a timer fills if the scene has changed: a panel that draws must not change anything."""
        global _listed
        now = _fingerprint(context.scene)
        if now != _listed:
            _listed = now
            bpy.app.timers.register(lambda: _fill_soon(now[0]), first_interval=0.01)
        layout: Any = self.layout  # type: ignore[attr-defined]
        values = context.window_manager.vibe_values
        layout.template_list("VIBE_UL_values", "", values, "rows", values, "active", rows=6)
        layout.operator("vibe.unlock_all", icon="UNLOCKED")


def _fingerprint(scene: bpy.types.Scene) -> tuple:
    counted = (scene.objects, bpy.data.materials, bpy.data.lights)
    return scene.session_uid, *map(len, counted), bool(scene.world), len(scene.vibe.changes)


def _fill_soon(uid: int) -> None:
    scene = next((s for s in bpy.data.scenes if s.session_uid == uid), None)
    if scene is not None:
        fill(scene)
        drawing.redraw()


def fill(scene: bpy.types.Scene) -> None:
    """Fills the list with the scene's values, each with its key, title and the reason if it is locked."""
    global _listed
    _listed = _fingerprint(scene)
    rows = bpy.context.window_manager.vibe_values.rows
    rows.clear()
    for instance in bindings.instances(scene, scene_context.meshes(scene), scene.vibe.pivot).values():
        row = rows.add()
        row.name, row.title = instance.key, labels.title(instance.key)
        row.reason = instance.locked


class VibeValue(bpy.types.PropertyGroup):
    """A value of the scene. Its `name` is the parameter's key."""

    title: StringProperty()
    reason: StringProperty(description="Why it must be left alone; empty where it may change")


class VibeValues(bpy.types.PropertyGroup):
    """The rows of the list, kept in the window manager, not in the scene."""

    rows: CollectionProperty(type=VibeValue)
    active: IntProperty(options={"SKIP_SAVE"})


class VIBE_UL_values(bpy.types.UIList):
    """One value and its lock on each line."""

    def draw_item(self, context, layout, _data, item, _icon, _active_data, _active) -> None:
        """Draws a value in one line: the icon of its group, its title, its lock."""
        settings, reason = context.scene.vibe, item.reason
        group = schema.split_key(item.name)[0]
        if not getattr(settings, f"change_{group}"):
            reason = f"{labels.GROUP_TITLES[group]} is not checked under Affect"
        row = layout.row(align=True)
        names = row.row()
        names.active = not reason
        names.label(text=item.title, icon=drawing.GROUP_ICONS[group])
        draw_lock(row, settings, item.name, reason)

    def filter_items(self, _context: bpy.types.Context, data: VibeValues, _name: str) -> tuple[list[int], list[int]]:
        """Shows the rows whose title or key has each word of the search field."""
        words = self.filter_name.casefold().split()
        shown = [all(w in f"{r.title} {r.name}".casefold() for w in words) for r in data.rows]
        return [self.bitflag_filter_item if show else 0 for show in shown], []


def draw_lock(layout: bpy.types.UILayout, settings: Any, key: str, reason: str = "") -> None:
    """Draws the lock of the value `key`; closed, with `reason` as tooltip, if there is a reason why it must stay."""
    row = layout.row()
    row.enabled = not reason
    icon = "LOCKED" if reason or key in settings.locks else "UNLOCKED"
    button = row.operator("vibe.lock", text="", icon=icon, emboss=False)
    button.key, button.reason = key, reason


class VIBE_OT_lock(Operator, label="Lock", options={"UNDO", "INTERNAL"}):
    """Lock a value, or unlock it"""

    key: StringProperty()
    reason: StringProperty()

    @classmethod
    def description(cls, context: bpy.types.Context, properties: bpy.types.OperatorProperties) -> str:
        if properties.reason:
            return f"Stays as it is: {properties.reason}"
        locked = properties.key in context.scene.vibe.locks
        title = labels.title(properties.key)
        return f"Let a vibe change {title}" if locked else f"Keep {title} as it is"

    def perform(self, context: bpy.types.Context) -> None:
        locks = context.scene.vibe.locks
        place = locks.find(self.key)
        if place >= 0:
            locks.remove(place)
        else:
            locks.add().name = self.key


class VIBE_OT_unlock_all(Operator, label="Unlock All", options={"UNDO"}):
    """Unlock all values that are locked one by one"""

    @classmethod
    def obstacle(cls, context: bpy.types.Context) -> str:
        return "" if context.scene.vibe.locks else "No value is locked"

    def perform(self, context: bpy.types.Context) -> None:
        context.scene.vibe.locks.clear()


class AdvancedPanel(IdlePanel):
    """Settings that few artists need: patterns of locked values, and numbers of the search."""

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.vibe  # type: ignore[attr-defined]
        column = layout.column()
        column.label(text=settings.bl_rna.properties["lock"].name)
        column.prop(settings, "lock", text="", placeholder="light/Key, */metallic")
        for name in ("top_k", "seed", "anchor"):
            column.prop(settings, name)
