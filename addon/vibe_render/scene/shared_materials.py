# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that the subject shares with other objects: finds them for a question to the artist, and separates them."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.types import Material, Object, Scene

from ..core.journal import Journal
from . import snapshot
from .nodes import owned


def shared_materials(subject: Sequence[Object]) -> dict[Material, list[Object]]:
    """The subject's materials that things outside of it use too, and those things, in this or other scenes.

    Those from a library are left out: nobody may change them.
    """
    inside, theirs = set(subject), {m for obj in subject for m in _materials_of(obj) if m.is_editable}
    users: dict[Material, list[Object]] = {}
    for obj in bpy.data.objects:
        if obj in inside or not obj.users_scene or owned.is_unseen(obj):
            continue
        for material in theirs.intersection(_materials_of(obj)):
            users.setdefault(material, []).append(obj)
    return users


def separate_materials(scene: Scene, subject: Sequence[Object]) -> None:
    """Gives the subject copies of its own, recorded in the scene's snapshot."""
    inside = set(subject)
    with snapshot.transaction(scene) as journal:
        for material in shared_materials(subject):
            twin = journal.copy("materials", material)
            for obj in subject:
                if obj.is_editable:
                    _replace_material(journal, obj, inside, material, twin)


def _materials_of(obj: Object) -> set[Material]:
    return {slot.material for slot in obj.material_slots if slot.material}


def _replace_material(
    journal: Journal, obj: Object, inside: set[Object], old: Material, new: Material
) -> None:
    """Puts a material into an object's slots; a mesh that others use keeps its own."""
    for slot in obj.material_slots:
        if slot.material != old:
            continue
        if slot.link == "DATA" and not _all_inside(obj, inside):
            journal.set(slot, "link", "OBJECT")
        journal.set(slot, "material", new)


def _all_inside(obj: Object, inside: set[Object]) -> bool:
    """Whether only the subject uses the object's data, which may be changed."""
    users = (other for other in bpy.data.objects if other.data == obj.data)
    return obj.data.is_editable and all(other in inside for other in users)
