# SPDX-License-Identifier: GPL-3.0-or-later
"""All code that depends on the version of Blender. Where possible it tests for a feature, not for a version number."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import bpy
from bpy.types import ID, Node, NodeSocket, NodeTree, Scene

from .journal import Journal, resolve

COMPOSITOR_IS_GROUP = "compositing_node_group" in Scene.bl_rna.properties  # 5.0 and later
# Option of a path property: the path may begin with "//"; Blender 5.0 and later need it.
_OPTIONS = bpy.types.Property.bl_rna.properties
RELATIVE_PATHS = {"PATH_SUPPORTS_BLEND_RELATIVE"} if "is_path_supports_blend_relative" in _OPTIONS else set()
IS_MODULE = not bpy.app.binary_path  # True for the Python module bpy, as `app.module` in 4.5 and later
EEVEE = "BLENDER_EEVEE" if COMPOSITOR_IS_GROUP else "BLENDER_EEVEE_NEXT"  # the identifier of the engine
GAMMA_NODE = "ShaderNodeGamma" if COMPOSITOR_IS_GROUP else "CompositorNodeGamma"


def pasted_picture(context: bpy.types.Context) -> bpy.types.Image | None:
    """The image in the clipboard as a new image data-block; None if the clipboard has no image."""
    # Blender pastes only into an image editor. If none is open, the current area becomes one for the moment.
    areas = [area for area in context.screen.areas if area.type == "IMAGE_EDITOR"]
    area = areas[0] if areas else context.area
    before, kind = set(bpy.data.images), area.ui_type
    try:
        area.type = "IMAGE_EDITOR"
        shown = area.spaces.active.image
        with context.temp_override(area=area):
            if not bpy.ops.image.clipboard_paste.poll():
                return None
            bpy.ops.image.clipboard_paste()
        area.spaces.active.image = shown
    finally:
        area.ui_type = kind
    return next((image for image in bpy.data.images if image not in before), None)


def enable_nodes(block: bpy.types.Material | bpy.types.World) -> NodeTree:
    """The node tree of a new material or world; in Blender 4, switches its nodes on, which creates the tree."""
    if block.node_tree is None:
        block.use_nodes = True
    return block.node_tree


def node_tree(block: Any) -> NodeTree | None:
    """The node tree that a material, world or light is rendered with; None if its nodes are off."""
    on = COMPOSITOR_IS_GROUP or block.use_nodes  # in Blender 5 they are always on, and `use_nodes` is deprecated
    return block.node_tree if on else None


def output_node(block: Any) -> Node | None:
    """The output node that Cycles uses in a material, world or light; None without a block, nodes or an output node."""
    tree = node_tree(block) if block else None
    return tree.get_output_node("CYCLES") if tree else None


def compositor(scene: Scene) -> NodeTree | None:
    """The compositor tree that is applied to the scene's renders; None if there is none."""
    if not scene.render.use_compositing:
        return None
    if COMPOSITOR_IS_GROUP:
        return scene.compositing_node_group
    return scene.node_tree if scene.use_nodes else None


def compositor_output(tree: NodeTree) -> NodeSocket | None:
    """The input socket of the output node that receives the final image; None without an unmuted output node."""
    kind = "NodeGroupOutput" if COMPOSITOR_IS_GROUP else "CompositorNodeComposite"
    outputs = [node for node in tree.nodes if node.bl_idname == kind and not node.mute]
    if kind == "NodeGroupOutput":
        outputs.sort(key=lambda node: not node.is_active_output)
    elif tree.nodes.active in outputs:
        outputs = [tree.nodes.active]
    return next((s for node in outputs for s in node.inputs if s.type == "RGBA"), None)


def set_option(node: Node, prop: str, socket: str, identifier: str, label: str) -> None:
    """Chooses from a node's menu: sets property `prop` to `identifier` in Blender 4, input `socket` to `label` in 5."""
    if prop in node.bl_rna.properties:
        setattr(node, prop, identifier)
    else:
        node.inputs[socket].default_value = label


def curves(block: ID) -> Iterator[bpy.types.FCurve]:
    """Yields all animation curves of a data-block: of its drivers, its action, and the actions in its NLA strips."""
    data = getattr(block, "animation_data", None)
    if data is None:
        return
    yield from data.drivers
    if data.action:
        yield from _action_curves(data.action, data.action_slot)
    for strip in (s for track in data.nla_tracks for s in track.strips if s.action):
        yield from _action_curves(strip.action, strip.action_slot)


def _action_curves(action: bpy.types.Action, slot: Any) -> Iterator[bpy.types.FCurve]:
    for strip in (s for layer in action.layers for s in layer.strips):
        bag = strip.channelbag(slot) if slot else None
        yield from bag.fcurves if bag else ()


def start_compositor(journal: Journal, scene: Scene) -> NodeTree:
    """Turns compositing on for a scene whose renders have none; returns a tree that links the render to the output."""
    journal.set(scene.render, "use_compositing", True)
    if COMPOSITOR_IS_GROUP:
        tree = journal.new("node_groups", "Vibe Compositor", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        # Without the override, the new node refers to the open scene and counts as a user of it.
        with bpy.context.temp_override(scene=scene):
            layers = tree.nodes.new("CompositorNodeRLayers")
        output = tree.nodes.new("NodeGroupOutput")
        layers.location = (-600.0, 0.0)
        tree.links.new(layers.outputs["Image"], output.inputs["Image"])
        journal.set(scene, "compositing_node_group", tree)
        return tree
    # Blender 4 uses a tree that the artist has switched off: its output is linked anew, its File Output nodes are muted.
    if scene.node_tree is None:
        journal.start_compositor(scene)
    tree = scene.node_tree
    journal.set(scene, "use_nodes", True)
    for node in [n for n in tree.nodes if n.bl_idname == "CompositorNodeOutputFile"]:
        journal.set(node, "mute", True)
    output = compositor_output(tree) or journal.node(tree, "CompositorNodeComposite", "Composite").inputs["Image"]
    journal.link(journal.node(tree, "CompositorNodeRLayers", "Render Layers").outputs["Image"], output)
    return tree


def drop_compositor(scene: Scene) -> None:
    """Turns compositing off for a scene that Vibe Render has made, such as a copy."""
    scene.render.use_compositing = False
    if COMPOSITOR_IS_GROUP:
        scene.compositing_node_group = None
    else:
        scene.use_nodes = False


def set_to_curve(block: ID, curve: bpy.types.FCurve, frame: float) -> None:
    """Sets a curve's property to the curve's value at `frame`; skips a muted curve, or a property that is gone."""
    if curve.mute:
        return
    path, _, name = curve.data_path.rpartition(".")
    with suppress(ValueError, AttributeError, TypeError):
        owner = resolve(block, path)
        value = getattr(owner, name)
        if hasattr(value, "__len__"):
            value[curve.array_index] = curve.evaluate(frame)
        else:
            setattr(owner, name, type(value)(curve.evaluate(frame)))


def drop_action(tree: NodeTree | None, frame: int | None = None) -> None:
    """Unlinks a copied tree from the original's action and NLA strips; its values become those at `frame`, if given."""
    # Otherwise Blender 5 deletes curves of the original when nodes of the copy are removed.
    data = tree.animation_data if tree else None
    if data is None:
        return
    if data.action and frame is not None:
        for curve in _action_curves(data.action, data.action_slot):
            set_to_curve(tree, curve, frame)
    data.action = None
    for track in list(data.nla_tracks):
        data.nla_tracks.remove(track)


def separate_compositor(twin: Scene, scene: Scene) -> list[NodeTree]:
    """Makes the compositor of `twin`, a copy of `scene`, read `twin` and write no files; returns added node groups."""
    tree = compositor(twin)
    if tree is None:
        return []
    if COMPOSITOR_IS_GROUP:
        tree = twin.compositing_node_group = tree.copy()
        drop_action(tree, twin.frame_current)
    inner = copy_groups(tree, twin.frame_current)
    for node in [node for each in (tree, *inner) for node in each.nodes]:
        if getattr(node, "scene", None) == scene:
            node.scene = twin
        if node.bl_idname == "CompositorNodeOutputFile":
            node.mute = True
    return [tree, *inner] if COMPOSITOR_IS_GROUP else inner


def copy_groups(tree: NodeTree, frame: int | None = None) -> list[NodeTree]:
    """Replaces a copied tree's node groups, nested ones too, by copies; returns them. `frame`: see `drop_action`."""
    trees = [tree]
    for each in trees:  # the loop appends the groups that it finds
        for node in each.nodes:
            if node.type == "GROUP" and node.node_tree:
                node.node_tree = node.node_tree.copy()
                drop_action(node.node_tree, frame)
                trees.append(node.node_tree)
    return trees[1:]


def editable_compositor(journal: Journal, scene: Scene) -> NodeTree:
    """A compositor tree that only this scene uses: its own, a copy of a shared one, or a new one if it has none."""
    tree = compositor(scene) or start_compositor(journal, scene)
    if not COMPOSITOR_IS_GROUP or sum(s.compositing_node_group == tree for s in bpy.data.scenes) < 2:
        return tree
    twin = journal.copy("node_groups", tree)
    journal.set(scene, "compositing_node_group", twin)
    return twin


def march_volumes(journal: Journal, scene: Scene) -> None:
    """Makes Blender 5 march volumes as Blender 4 does, except with volume objects; large fog boxes start sooner."""
    # Vibe Render's fog looks the same; volume objects of the artist would change.
    ours = not any(o.type == "VOLUME" for o in scene.objects)
    if ours and not getattr(scene.cycles, "volume_biased", True):
        journal.set(scene.cycles, "volume_biased", True)


def assign(owner: bpy.types.bpy_struct, **values: Any) -> None:
    """Sets properties of `owner` in the given order; skips those that this version of Blender does not have."""
    for name, value in values.items():
        if name in owner.bl_rna.properties:
            setattr(owner, name, value)


@contextmanager
def changed(owner: bpy.types.bpy_struct, **values: Any) -> Iterator[None]:
    """Sets properties as `assign` does; after the `with` block, restores the old values in reverse order."""
    old = []
    try:
        for name, value in values.items():
            if name in owner.bl_rna.properties:
                before = getattr(owner, name)
                # arrays are views into Blender's data: copy the present values
                before = before[:] if hasattr(before, "__len__") else before
                try:
                    setattr(owner, name, before)
                except TypeError:  # such as an option from an older file that Blender has dropped
                    continue
                old.append((name, before))
                setattr(owner, name, value)
        yield
    finally:
        for name, value in reversed(old):
            setattr(owner, name, value)
