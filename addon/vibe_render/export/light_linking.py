# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: which objects a light is kept from."""

from __future__ import annotations

from collections.abc import Sequence

from bpy.types import Collection, Object, Scene

from ..scene import scene_context
from ..scene.nodes import layers


def unlit_objects(light: Object, objects: Sequence[tuple[str, str]]) -> list[int]:
    """The numbers of the objects that a light does not light.

    Args:
        objects: Names as in `SceneGeometry.objects`: an instance's instancer, and what it is an instance of.
    """
    collection = light.light_linking.receiver_collection
    if collection is None:
        return []
    included, excluded = _linked_names(collection, "INCLUDE"), _linked_names(collection, "EXCLUDE")
    rows = [{name for name in names if name} for names in objects]
    return [
        number for number, names in enumerate(rows) if names & excluded or (included and not names & included)
    ]


def _linked_names(collection: Collection, state: str) -> set[str]:
    """Names of the objects that a collection of receivers has in a state."""
    pairs = zip(collection.objects, collection.collection_objects, strict=True)
    names = {o.name_full for o, row in pairs if row.light_linking.link_state == state}
    children = zip(collection.children, collection.collection_children, strict=True)
    for child, row in children:
        if row.light_linking.link_state == state:
            names |= {o.name_full for o in child.all_objects}
    return names


def ignored_links(scene: Scene) -> list[str]:
    """What of the light linking in a scene the prediction leaves out, in words for the artist."""
    notes = []
    for obj in (o for o in scene.objects if scene_context.visible(scene, o)):
        linking = obj.light_linking
        if linking.blocker_collection:
            notes.append(
                f"Shadow linking of {obj.name} is left out: in the prediction all objects cast its shadows."
            )
        if linking.receiver_collection and obj.type in scene_context.GEOMETRY and _glows(obj):
            notes.append(f"{obj.name} is linked to some objects; in the prediction its glow lights all.")
    return notes


def _glows(obj: Object) -> bool:
    return any(slot.material and layers.radiance(slot.material) > 0.0 for slot in obj.material_slots)
