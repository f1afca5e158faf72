# SPDX-License-Identifier: GPL-3.0-or-later
"""Light linking: a light that Vibe Render links gets a new receiver collection, which refers to the artist's one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from bpy.types import Collection, Object, Scene

from ..core.journal import Journal
from ..core.schema_import import schema
from .nodes import owned

_LINKS, _BEFORE = "vibe_links", "vibe_before"
"""Properties of an added receiver collection: the keys of its links, and the artist's collection that it replaces."""
States = dict[str, set[Object]]  # "INCLUDE" and "EXCLUDE" -> objects


def states(collection: Collection | None) -> States:
    """Link state -> objects of a receiver collection; objects in a child collection have the child's state."""
    found: States = {"INCLUDE": set(), "EXCLUDE": set()}
    if collection is None:
        return found
    for obj, row in zip(collection.objects, collection.collection_objects, strict=True):
        found[row.light_linking.link_state].add(obj)
    for child, row in zip(collection.children, collection.collection_children, strict=True):
        found[row.light_linking.link_state].update(child.all_objects)
    return found


def read(scene: Scene) -> dict[str, schema.Values]:
    """Key -> (1.0,) for each light link that Vibe Render has added to a scene."""
    receivers = (o.light_linking.receiver_collection for o in scene.objects if o.type == "LIGHT")
    return {key: (1.0,) for each in receivers if each for key in each.get(_LINKS, ())}


def put(journal: Journal, scene: Scene, values: Mapping[str, Sequence[float]]) -> dict[str, str]:
    """Adds (value 1) or removes (0) light links by key, ignores other keys; returns key -> reason for links not set."""
    rest: dict[str, str] = {}
    wanted: dict[Object, dict[str, bool]] = {}
    for key, value in values.items():
        link = schema.light_links.link_of(key)
        light = scene.objects.get(link.light) if link else None
        if light and light.is_editable:
            wanted.setdefault(light, {})[key] = schema.light_links.is_on(value)
        elif link:
            rest[key] = "it is linked from a library" if light else "there is no such light in this scene"
    for light, switched in wanted.items():
        now = light.light_linking.receiver_collection
        ours = now if now and _LINKS in now else None
        before = ours.get(_BEFORE) if ours else now
        old = list(ours[_LINKS]) if ours else []
        new = [key for key in old if switched.get(key, True)]
        new += [key for key, on in switched.items() if on and key not in new]
        if new != old:
            receivers = _receivers(journal, scene, light, before, new) if new else before
            journal.set(light.light_linking, "receiver_collection", receivers)
    return rest


def _receivers(journal: Journal, scene: Scene, light: Object, before: Collection | None, keys: list[str]) -> Collection:
    """A new receiver collection: the objects of the artist's one (`before`), changed by each link of `keys` in turn."""
    receivers = owned.new(journal, "collections", f"Vibe Receivers of {light.name}", role="Vibe Receivers")
    receivers[_LINKS] = keys
    if before:
        receivers[_BEFORE] = before
    found = states(before)
    for link in filter(None, map(schema.light_links.link_of, keys)):
        named = {scene.objects[name] for name in link.objects if name in scene.objects}
        if link.only:
            found = {"INCLUDE": named, "EXCLUDE": set()}
        else:
            found = {"INCLUDE": found["INCLUDE"] - named, "EXCLUDE": found["EXCLUDE"] | named}
    by_object = {obj: state for state, objects in found.items() for obj in objects}
    for obj in sorted(by_object, key=lambda each: each.name_full):
        receivers.objects.link(obj)
    for obj, row in zip(receivers.objects, receivers.collection_objects, strict=True):
        row.light_linking.link_state = by_object[obj]
    return receivers
