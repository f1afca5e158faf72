# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes to a .blend that can be undone: a journal records each change, and undoes them from the last to the first."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import bpy
from bpy.types import ID, FCurve, Node, NodeSocket, NodeTree, bpy_struct

JournalEntry = dict[str, Any]
KEYFRAMES = "Vibe Render"  # the group of Vibe Render's curves in an action; the others are the artist's
HELD = "vibe_held"  # custom property of an action: `held_name` of each curve of the artist that Vibe Render has muted
Keys = list[list[float]]  # a row for each keyframe: its value, and the values of its left and right handle
# Errors that Blender raises when the artist has removed or changed what an entry refers to.
_GONE = (LookupError, ValueError, AttributeError, ReferenceError)


@dataclass
class Journal:
    """Makes changes to the file and records them. Raises LookupError for an embedded node tree that nothing owns."""

    entries: list[JournalEntry] = field(default_factory=list)  # one for each change, the oldest first; JSON
    # the data-blocks to which entries refer by index, because names may change; None in place of a deleted one
    ids: list[ID | None] = field(default_factory=list)

    def refer(self, block: ID) -> int:
        """The index of a data-block in `ids`, which it is added to if missing."""
        if block not in self.ids:
            self.ids.append(block)
        return self.ids.index(block)

    def set(self, owner: bpy_struct, name: str, value: Any) -> None:
        """Sets a property of a data-block or of a struct in one: a number, a string, an array or a pointer to a data-block."""
        self._note("set", owner, name=name, old=self._plain(getattr(owner, name)))
        setattr(owner, name, value)

    def link(self, source: NodeSocket, target: NodeSocket) -> None:
        """Links an output to an input of the same tree, in place of the input's former link."""
        tree = target.id_data
        old = _end(target.links[0].from_socket) if target.is_linked else None
        self._note("link", tree, source=_end(source), target=_end(target), old=old)
        tree.links.new(source, target)

    def node(self, tree: NodeTree, kind: str, name: str) -> Node:
        """Adds a node to a tree; `kind`: its `bl_idname` ("ShaderNodeMix"). Blender numbers a name that is taken."""
        node = tree.nodes.new(kind)
        node.name = name
        self._note("node", tree, node=node.name)
        return node

    def new(self, collection: str, name: str, *kind: Any) -> Any:
        """Adds a data-block to a `collection` of `bpy.data` ("lights"); `kind`: further arguments of its `new`."""
        block = getattr(bpy.data, collection).new(name, *kind)
        self.entries.append({"op": "new", "id": self.refer(block), "collection": collection})
        return block

    def copy(self, collection: str, block: ID) -> Any:
        """Adds a copy of a data-block; `collection` names its collection in `bpy.data`, such as "materials"."""
        twin = block.copy()
        self.entries.append({"op": "new", "id": self.refer(twin), "collection": collection})
        return twin

    def append_material(self, data: ID, material: bpy.types.Material) -> None:
        """Adds a slot with the material to a mesh or curve that has no slots."""
        self.entries.append({"op": "slot", "id": self.refer(data)})
        data.materials.append(material)

    def light_group(self, layer: bpy.types.ViewLayer, name: str) -> str:
        """Adds a light group to a view layer; returns its name, which Blender makes unique."""
        name = layer.lightgroups.add(name=name).name
        self._note("lightgroup", layer, name=name)
        return name

    def curve(self, owner: bpy_struct, name: str, index: int) -> FCurve:
        """Adds an animation curve without keyframes for component `index` of property `name`.

        Raises LookupError if the data-block's action has keyframes, but only of other data-blocks.
        """
        block = owner.id_data
        data, bag = block.animation_data, _channelbag(block)
        if bag is None:
            if data and data.action:  # of the artist, for other data-blocks
                raise LookupError(f"{data.action.name} has no keyframes of {block.name}")
            action = self.new("actions", f"Vibe {block.name}")
            self._note("action", block, had=data is not None, slot=data.last_slot_identifier if data else "")
            data = data or block.animation_data_create()
            data.action = action
            data.action_slot = action.slots.new(block.id_type, block.name)
            strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
            bag = strip.channelbag(data.action_slot, ensure=True)
        path = name if isinstance(owner, ID) else f"{owner.path_from_id()}.{name}"
        curve = bag.fcurves.new(path, index=index)
        curve.group = bag.groups.get(KEYFRAMES) or bag.groups.new(KEYFRAMES)
        self._note("curve", block, curve=path, index=index)
        return curve

    def hold(self, block: ID, curve: FCurve, key: str, was: float) -> None:
        """Mutes a curve of the artist, so that its property can change; `key`: the parameter, `was`: its value now."""
        place = {"curve": curve.data_path, "index": curve.array_index}
        self._note("held", block, **place, keys=keys_of(curve), key=key, was=was)
        mark_held(curve, True)

    def curves(self, op: str) -> list[tuple[JournalEntry, Any, FCurve]]:
        """(entry, data-block, curve) of each curve left that `hold` muted (`op` "held") or `curve` added ("curve")."""
        entries = [e for e in self.entries if e["op"] == op and self.ids[e["id"]]]
        blocks = ((entry, resolve(self.ids[entry["id"]], entry["path"])) for entry in entries)
        return [(entry, block, curve) for entry, block in blocks if (curve := _curve(block, entry))]

    def _note(self, op: str, struct: bpy_struct, **rest: Any) -> None:
        block, path = address(struct)
        self.entries.append({"op": op, "id": self.refer(block), "path": path, **rest})

    def start_compositor(self, scene: bpy.types.Scene) -> None:
        """Makes an empty compositor tree for a scene that has none, in Blender 4."""
        self.entries.append({"op": "compositor", "id": self.refer(scene)})
        images = set(bpy.data.images)
        scene.use_nodes = True
        scene.node_tree.nodes.clear()
        for image in set(bpy.data.images) - images:  # the image of the Viewer node that Blender adds
            bpy.data.images.remove(image)

    def remember(self) -> None:
        """Records the present values of all properties that were set; `undo` skips those that change afterwards."""
        for entry in self.entries:
            if entry["op"] == "set":
                owner = resolve(self.ids[entry["id"]], entry["path"])
                entry["new"] = self._plain(getattr(owner, entry["name"]))

    def _changed_since(self, entry: JournalEntry) -> bool:
        """True if an entry's property no longer has the value that `remember` recorded; False if none was recorded."""
        block = self.ids[entry["id"]]
        if "new" not in entry or block is None:
            return False
        try:
            return self._plain(getattr(resolve(block, entry["path"]), entry["name"])) != entry["new"]
        except _GONE:  # `undo` reports it
            return False

    def _plain(self, value: Any) -> Any:
        if isinstance(value, ID):
            return {"id": self.refer(value)}
        return value if isinstance(value, bool | int | float | str | None) else list(value)

    def undo(self, first: int = 0) -> list[str]:
        """Undoes the changes from entry `first` on, deletes their entries, and returns a text for each that failed."""
        lost: list[str] = []
        added: list[tuple[str, ID]] = []
        # Compare before anything is undone: undoing one value may change another, as a matrix does a location.
        left = [entry for entry in self.entries[first:] if not self._changed_since(entry)]
        for entry in reversed(left):
            block = self.ids[entry["id"]]
            try:
                if block is None:
                    raise LookupError
                if entry["op"] == "new":
                    added.append((entry["collection"], block))
                else:
                    self._undo_entry(block, entry)
            except (*_GONE, TypeError, RuntimeError):  # go on with the other entries
                lost.append(_loss(block, entry))
        del self.entries[first:]
        self._remove(added)
        return lost

    def _undo_entry(self, block: Any, entry: JournalEntry) -> None:
        """Undoes one change of a data-block; slots, links and actions that the artist has changed since then stay."""
        op = entry["op"]
        if op == "compositor":
            block.node_tree.nodes.clear()
            block.use_nodes = False
            return
        if op == "slot":
            if len(block.materials) > 1:  # the artist has added others
                block.materials[0] = None
            else:
                block.materials.clear()
            return
        owner = resolve(block, entry["path"])
        if op == "curve":
            _channelbag(owner).fcurves.remove(_curve(owner, entry))
        elif op == "held":
            curve = _curve(owner, entry)
            mark_held(curve, False)
            set_keys(curve, entry["keys"])
        elif op == "action":
            bag, data = _channelbag(owner), owner.animation_data
            if bag is not None and not bag.fcurves:  # else there are curves of the artist
                data.action = None
                data.last_slot_identifier = entry["slot"]
                if not (entry["had"] or data.drivers or data.nla_tracks):
                    owner.animation_data_clear()
        elif op == "set":
            old = entry["old"]
            setattr(owner, entry["name"], self.ids[old["id"]] if isinstance(old, dict) else old)
        elif op == "lightgroup":
            owner.lightgroups.remove(owner.lightgroups[entry["name"]])
        elif op == "node":
            owner.nodes.remove(owner.nodes[entry["node"]])
        elif op == "link":
            target = _socket(owner, entry["target"], "inputs")
            if target.is_linked and _end(target.links[0].from_socket) == entry["source"]:
                owner.links.remove(target.links[0])
                if entry["old"]:
                    owner.links.new(_socket(owner, entry["old"], "outputs"), target)

    def _remove(self, added: list[tuple[str, ID]]) -> None:
        """Removes added data-blocks: objects always, collections without users or content, others without users."""

        def is_free(block: ID) -> bool:
            if isinstance(block, bpy.types.Collection):
                return not (block.users and (block.all_objects or block.children))
            return isinstance(block, bpy.types.Object) or block.users == block.use_fake_user

        while free := [pair for pair in added if is_free(pair[1])]:
            for collection, block in free:
                self.ids[self.ids.index(block)] = None
                getattr(bpy.data, collection).remove(block)
            added = [pair for pair in added if pair not in free]

    def extend(self, later: Journal) -> None:
        """Appends a journal of later changes. Properties that this journal has already recorded keep their first record."""
        number = {i: self.refer(block) for i, block in enumerate(later.ids) if block is not None}
        recorded = {(e["id"], e["path"], e["name"]) for e in self.entries if e["op"] == "set"}
        for entry in later.entries:
            entry = {**entry, "id": number[entry["id"]]}
            if entry["op"] == "set":
                if (entry["id"], entry["path"], entry["name"]) in recorded:
                    continue
                if isinstance(entry["old"], dict):
                    entry["old"] = {"id": number[entry["old"]["id"]]}
            self.entries.append(entry)


def address(struct: bpy_struct) -> tuple[ID, str]:
    """The data-block that owns a struct, and the struct's path in this data-block.

    The owner of an embedded node tree is the material, world, scene or light with this tree; LookupError without one.
    """
    root = struct.id_data
    # `path_from_id` does not work for a view layer's Cycles settings.
    layer = next((each for each in getattr(root, "view_layers", ()) if getattr(each, "cycles", None) == struct), None)
    if layer:
        return root, f"{layer.path_from_id()}.cycles"
    path = "" if isinstance(struct, ID) else struct.path_from_id()
    if not (isinstance(root, NodeTree) and root.is_embedded_data):
        return root, path
    for collection in (bpy.data.materials, bpy.data.worlds, bpy.data.scenes, bpy.data.lights):
        for block in collection:
            if getattr(block, "node_tree", None) == root:
                return block, f"node_tree.{path}".rstrip(".")
    raise LookupError(f"nobody owns {root.name}")


def _loss(block: ID | None, entry: JournalEntry) -> str:
    """Text on an entry that could not be undone: 'a value of "Monkey": node "Principled BSDF" is gone or changed'."""
    try:
        name = f'"{block.name}"' if block else ""
    except ReferenceError:
        name = ""
    if not name:
        return "a value of something that is gone"
    node = re.search(r'nodes\["(.+?)"\]', entry.get("path", ""))
    inside = f'node "{node[1]}"' if node else "it"
    return f"a value of {name}: {inside} is gone or changed"


def resolve(block: ID, path: str) -> Any:
    """The struct at a path in a data-block; the data-block itself at ""."""
    return block.path_resolve(path) if path else block


def _channelbag(block: ID) -> Any:
    """The channelbag (keyframes) of a data-block in its action; None if there is none."""
    data = block.animation_data
    if not (data and data.action and data.action_slot):
        return None
    bags = (s.channelbag(data.action_slot) for layer in data.action.layers for s in layer.strips)
    return next(filter(None, bags), None)


def _curve(block: ID, entry: JournalEntry) -> FCurve | None:
    bag = _channelbag(block)
    return bag.fcurves.find(entry["curve"], index=entry["index"]) if bag else None


def held_name(curve: FCurve) -> str:
    """The name of a curve in `HELD`, the action's list of muted curves: data path and array index."""
    return f"{curve.data_path}[{curve.array_index}]"


def mark_held(curve: FCurve, held: bool) -> None:
    """Mutes a curve of the artist and lists it in `HELD` if `held` is True; otherwise reverses both."""
    action, name = curve.id_data, held_name(curve)
    names = [each for each in action.get(HELD, ()) if each != name] + [name] * held
    curve.mute = held
    if names:
        action[HELD] = names
    elif HELD in action:
        del action[HELD]


def keys_of(curve: FCurve) -> Keys:
    """(value, left handle's value, right handle's value) of each keyframe of a curve."""
    return [[p.co.y, p.handle_left.y, p.handle_right.y] for p in curve.keyframe_points]


def set_keys(curve: FCurve, keys: Keys) -> None:
    """Sets the values of a curve's keyframes and handles; raises ValueError if their number has changed."""
    for point, (value, left, right) in zip(curve.keyframe_points, keys, strict=True):
        point.co.y, point.handle_left.y, point.handle_right.y = value, left, right
    curve.update()


def _end(socket: NodeSocket) -> list[str]:
    return [socket.node.name, socket.identifier]


def _socket(tree: NodeTree, end: list[str], side: str) -> NodeSocket:
    sockets = getattr(tree.nodes[end[0]], side)
    return next(s for s in sockets if s.identifier == end[1])
