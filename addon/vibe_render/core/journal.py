# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes to a .blend, made so that every one of them can be taken back.

A journal writes down what it is about to change. Its entries are JSON, its data-blocks are named by
their place in `ids`, so that an artist may rename them, and undoing is replaying it backwards.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any

import bpy
from bpy.types import ID, FCurve, Node, NodeSocket, NodeTree, bpy_struct

JournalEntry = dict[str, Any]
KEYFRAMES = "Vibe Render"
"""The group of our curves, among those of the artist's in an action."""
HELD = "vibe_held"
"""The property of an action that names its curves that are the artist's and muted by us."""
Keys = list[list[float]]  # of each keyframe: its value, and those of its left and right handle
_GONE = (LookupError, ValueError, AttributeError, ReferenceError)
"""Errors of Blender where something is not as it was."""


@dataclass
class Journal:
    """Recorded changes. What is in a tree that no data-block owns is a LookupError."""

    entries: list[JournalEntry] = field(default_factory=list)  # in their order
    # the data-blocks that the entries speak of; None where one has been deleted since
    ids: list[ID | None] = field(default_factory=list)

    def refer(self, block: ID) -> int:
        """The index of a data-block in `ids`."""
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
        """Adds a node of a `bl_idname` ("ShaderNodeMix"); Blender numbers a name that is taken."""
        node = tree.nodes.new(kind)
        node.name = name
        self._note("node", tree, node=node.name)
        return node

    def new(self, collection: str, name: str, *kind: Any) -> Any:
        """Adds a data-block, numbered if its name is taken; `kind` is what else `bpy.data`'s `new` takes."""
        block = getattr(bpy.data, collection).new(name, *kind)
        self.entries.append({"op": "new", "id": self.refer(block), "collection": collection})
        return block

    def copy(self, collection: str, block: ID) -> Any:
        """Adds a copy of a data-block, which is in this collection of `bpy.data`: "materials"."""
        twin = block.copy()
        self.entries.append({"op": "new", "id": self.refer(twin), "collection": collection})
        return twin

    def append_material(self, data: ID, material: bpy.types.Material) -> None:
        """Adds the first material slot to a mesh or curve, which has none."""
        self.entries.append({"op": "slot", "id": self.refer(data)})
        data.materials.append(material)

    def light_group(self, layer: bpy.types.ViewLayer, name: str) -> str:
        """Adds a light group to a view layer; returns its name, which Blender makes unique."""
        name = layer.lightgroups.add(name=name).name
        self._note("lightgroup", layer, name=name)
        return name

    def channelbag(self, block: ID) -> Any:
        """The keyframes of a data-block or its node tree; a LookupError if its action has none for it."""
        data = block.animation_data
        if data and data.action:
            if (bag := _channelbag(block)) is None:
                raise LookupError(f"{data.action.name} has no keyframes of {block.name}")
            return bag
        action = self.new("actions", f"Vibe {block.name}")
        self._note("action", block, had=data is not None, slot=data.last_slot_identifier if data else "")
        data = data or block.animation_data_create()
        data.action = action
        data.action_slot = action.slots.new(block.id_type, block.name)
        strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
        return strip.channelbag(data.action_slot, ensure=True)

    def curve(self, owner: bpy_struct, name: str, index: int) -> FCurve:
        """Adds a curve without keys for a property, or for a component of an array; raises LookupError as `channelbag`."""
        block = owner.id_data
        bag = self.channelbag(block)
        path = name if isinstance(owner, ID) else f"{owner.path_from_id()}.{name}"
        curve = bag.fcurves.new(path, index=index)
        curve.group = bag.groups.get(KEYFRAMES) or bag.groups.new(KEYFRAMES)
        self._note("curve", block, curve=path, index=index)
        return curve

    def hold(self, block: ID, curve: FCurve, key: str, was: float) -> None:
        """Mutes a curve of the artist's, so that a value can change, by its key; `was` is what the curve gives now."""
        place = {"curve": curve.data_path, "index": curve.array_index}
        self._note("held", block, **place, keys=keys_of(curve), key=key, was=was)
        mark_held(curve, True)

    def curves(self, op: str) -> list[tuple[JournalEntry, Any, FCurve]]:
        """The entries of `hold` ("held") or `curve` ("curve") whose curves are still there, each with what that animates, and the curve."""
        entries = [e for e in self.entries if e["op"] == op and self.ids[e["id"]]]
        blocks = ((entry, resolve(self.ids[entry["id"]], entry["path"])) for entry in entries)
        return [(entry, block, curve) for entry, block in blocks if (curve := _curve(block, entry))]

    def _note(self, op: str, struct: bpy_struct, **rest: Any) -> None:
        """Adds an entry about a data-block, or about a struct in one."""
        block, path = address(struct)
        self.entries.append({"op": op, "id": self.refer(block), "path": path, **rest})

    def start_compositor(self, scene: bpy.types.Scene) -> None:
        """Makes the compositor tree of a scene in Blender 4 that has none yet, empty."""
        self.entries.append({"op": "compositor", "id": self.refer(scene)})
        images = set(bpy.data.images)
        scene.use_nodes = True
        scene.node_tree.nodes.clear()
        for image in set(bpy.data.images) - images:  # of the Viewer node that Blender puts there
            bpy.data.images.remove(image)

    def remember(self) -> None:
        """Notes what has been set: `undo` then leaves alone what has another value by that time."""
        for entry in self.entries:
            if entry["op"] == "set":
                owner = resolve(self.ids[entry["id"]], entry["path"])
                entry["new"] = self._plain(getattr(owner, entry["name"]))

    def _changed_since(self, entry: JournalEntry) -> bool:
        """True if a value is another one than `remember` has noted."""
        block = self.ids[entry["id"]]
        if "new" not in entry or block is None:
            return False
        try:
            return self._plain(getattr(resolve(block, entry["path"]), entry["name"])) != entry["new"]
        except _GONE:  # undo says so
            return False

    def _plain(self, value: Any) -> Any:
        if isinstance(value, ID):
            return {"id": self.refer(value)}
        return value if isinstance(value, bool | int | float | str | None) else list(value)

    def undo(self, first: int = 0) -> list[str]:
        """Undoes and forgets the entries from the first on; returns what the artist has removed, in words."""
        lost: list[str] = []
        added: list[tuple[str, ID]] = []
        # Before anything is undone: one value may follow from another, as a location from a matrix.
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
            except (*_GONE, TypeError, RuntimeError):  # the rest comes back all the same
                lost.append(_loss(block, entry))
        del self.entries[first:]
        self._remove(added)
        return lost

    def _undo_entry(self, block: Any, entry: JournalEntry) -> None:
        """Undoes a change of a data-block; what the artist has changed since then stays."""
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
            _drop_action(owner, entry)
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
        """Removes data-blocks without users; objects always, because their collections use them, and collections also once empty."""

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
        """Appends a journal of later changes. Values that this one has already recorded keep their first record."""
        number = {i: self.refer(block) for i, block in enumerate(later.ids) if block is not None}
        recorded = {_slot(entry) for entry in self.entries if entry["op"] == "set"}
        for entry in later.entries:
            entry = {**entry, "id": number[entry["id"]]}
            if entry["op"] == "set":
                if _slot(entry) in recorded:
                    continue
                if isinstance(entry["old"], dict):
                    entry["old"] = {"id": number[entry["old"]["id"]]}
            self.entries.append(entry)


def address(struct: bpy_struct) -> tuple[ID, str]:
    """The data-block that owns a struct, and the path from there; node trees inside others included."""
    root = struct.id_data
    # Cycles' settings of a view layer do not know their own path.
    layer = next(
        (each for each in getattr(root, "view_layers", ()) if getattr(each, "cycles", None) == struct), None
    )
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
    """A loss in words for the artist: 'a value of "Monkey": node "Principled BSDF" is gone or changed'."""
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
    """The keyframes of a data-block in its action; None if there are none."""
    data = block.animation_data
    if not (data and data.action and data.action_slot):
        return None
    bags = (s.channelbag(data.action_slot) for layer in data.action.layers for s in layer.strips)
    return next(filter(None, bags), None)


def _curve(block: ID, entry: JournalEntry) -> FCurve | None:
    bag = _channelbag(block)
    return bag.fcurves.find(entry["curve"], index=entry["index"]) if bag else None


def held_name(curve: FCurve) -> str:
    """The name of a curve among those of its action that are held."""
    return f"{curve.data_path}[{curve.array_index}]"


def mark_held(curve: FCurve, held: bool) -> None:
    """Mutes a curve of the artist's and remembers that, or ends both."""
    action, name = curve.id_data, held_name(curve)
    names = [each for each in action.get(HELD, ()) if each != name] + [name] * held
    curve.mute = held
    if names:
        action[HELD] = names
    elif HELD in action:
        del action[HELD]


def keys_of(curve: FCurve) -> Keys:
    """The values of a curve's keyframes."""
    return [[p.co.y, p.handle_left.y, p.handle_right.y] for p in curve.keyframe_points]


def set_keys(curve: FCurve, keys: Keys) -> None:
    """Gives a curve's keyframes other values; raises ValueError if it has got other ones since."""
    for point, (value, left, right) in zip(curve.keyframe_points, keys, strict=True):
        point.co.y, point.handle_left.y, point.handle_right.y = value, left, right
    curve.update()


def _drop_action(block: ID, entry: JournalEntry) -> None:
    """Takes a data-block's action away, unless there are keyframes of the artist's in it."""
    bag, data = _channelbag(block), block.animation_data
    if bag is None or bag.fcurves:
        return
    data.action = None
    data.last_slot_identifier = entry["slot"]
    if not (entry["had"] or data.drivers or data.nla_tracks):
        block.animation_data_clear()


def _slot(entry: JournalEntry) -> tuple:
    return entry["id"], entry["path"], entry["name"]


def _end(socket: NodeSocket) -> list[str]:
    return [socket.node.name, socket.identifier]


def _socket(tree: NodeTree, end: list[str], side: str) -> NodeSocket:
    sockets = getattr(tree.nodes[end[0]], side)
    return next(s for s in sockets if s.identifier == end[1])
