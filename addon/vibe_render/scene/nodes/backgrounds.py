# SPDX-License-Identifier: GPL-3.0-or-later
"""Background nodes of a world, in two parts: "light" lights the scene, "backdrop" is only seen by the camera."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bpy.types import Scene, World
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

from ...core import compat, locks
from ...core.journal import Journal
from ...core.schema_import import labels, schema
from ...core.value_slots import DerivedSlot, LazySlot, ValueSlot
from . import owned, trails
from .inputs import HORIZON, artists_origin, input_slot, own_groups
from .layers import BACKGROUND, Layer, MixSide, behind
from .trails import NodeEntry, NodeInGroups, active_links, resolve, search

LIGHT, BACKDROP = "light", "backdrop"
_LEFT = 200.0  # from an added node to the next
HORIZON_KEY = "world/backdrop_horizon"
WORLD_OF_BACKDROP = {f"world/backdrop_{name}": f"world/{name}" for name in ("color", "tint", "strength")} | {
    HORIZON_KEY: ""
}
"""Parameter of a backdrop -> the world's parameter that it starts from; "" for the horizon, which starts untinted."""
NO_HORIZON = (1.0, 1.0, 1.0)  # the tint at the horizon that changes nothing


def has_backdrop(world: World | None) -> bool:
    """True if a Mix Shader by Is Camera Ray shows the camera other Backgrounds than those that light the scene."""
    return bool(layers_of_part(world, BACKDROP))


def mixed_backgrounds(world: World | None, part: str = LIGHT) -> list[Layer]:
    """The Backgrounds that are mixed into a part (LIGHT or BACKDROP) of a world; empty for a single, plain Background.

    A single Background counts as a mix if nodes compute its strength, if its color depends on the kind of ray, or if it
    has a share in a Mix Shader.
    """
    found = layers_of_part(world, part)
    if len(found) != 1:
        return found
    color, strength = found[0].shader.entry("Color"), found[0].shader.entry("Strength")
    computed = strength is not None and artists_origin(strength).source is not None
    by_ray = color is not None and search(color, "ShaderNodeLightPath") is not None
    return found if computed or by_ray or any(map(_weighs, found[0].sides)) else []


def single_background(world: World | None, part: str = LIGHT) -> NodeInGroups | None:
    """The only Background of a part (LIGHT or BACKDROP) of a world; None if several are mixed, or if there is none."""
    found = [] if mixed_backgrounds(world, part) else layers_of_part(world, part)
    return next((layer.shader for layer in found if layer.kind == BACKGROUND), None)


def mixed_entries(world: World, part: str, name: str) -> list[NodeEntry]:
    """Input `name` of each mixed Background of a world's part; of inputs that get the same value, only the first."""
    layers = mixed_backgrounds(world, part)
    alike = tuple(s for layer in layers if (s := layer.shader.input(name)))
    return trails.distinct(layer.shader.entry(name, alike) for layer in layers)


def layers_of_part(world: World | None, part: str) -> list[Layer]:
    """The shaders of a part (LIGHT or BACKDROP) of a world's surface; without a separate backdrop, all are LIGHT."""
    output = compat.output_node(world)
    layers = list(behind(output.inputs["Surface"])) if output else []
    # True for a Background for camera rays alone, False for all other rays, None for both
    ways = [next((side.second for side in layer.sides if not _weighs(side)), None) for layer in layers]
    if {*ways} != {True, False}:
        return layers if part == LIGHT else []
    return [layer for layer, way in zip(layers, ways, strict=True) if way == (part == BACKDROP)]


def _weighs(side: MixSide) -> bool:
    source = resolve(side.factor).source
    return not (source and source.node.type == "LIGHT_PATH" and source.name == "Is Camera Ray")


def environment(world: World) -> NodeInGroups | None:
    """The environment texture of a world with a single Background; None without such a texture."""
    background = single_background(world)
    color = background.entry("Color") if background else None
    return search(color, "ShaderNodeTexEnvironment") if color else None


def is_only_turned(world: World) -> bool:
    """True if a world's environment texture is mapped unchanged, or only turned around Z; also without a texture."""
    texture = environment(world)
    ways = _ways(texture) if texture else []
    if len(ways) != 1 or ways[0].node.bl_idname != "ShaderNodeMapping":
        return not ways
    inputs = ways[0].node.inputs
    plain = not any(inputs["Rotation"].default_value[:2]) and not any(inputs["Location"].default_value)
    computed = any(active_links(inputs[name]) for name in ("Location", "Rotation", "Scale"))
    return plain and set(inputs["Scale"].default_value) == {1.0} and not computed


def _ways(texture: NodeInGroups) -> list[NodeInGroups]:
    """The nodes that compute a texture's direction, from the texture backwards; without a Texture Coordinate node."""
    found: list[NodeInGroups] = []
    socket, inside = texture.node.inputs["Vector"], texture.inside
    while before := trails.source_output(socket, inside):
        output, inside = before
        if output.node.bl_idname == "ShaderNodeTexCoord" and output.name == "Generated":
            break
        found.append(NodeInGroups(output.node, inside))
        if output.node.bl_idname != "ShaderNodeMapping":
            break
        socket = output.node.inputs["Vector"]
    return found


def rotation_slot(world: World) -> ValueSlot | None:
    """The slot that turns a world's environment texture, radians: of its Mapping node, or of one that writing adds.

    None if the world has no such texture.
    """
    texture = environment(world)
    if not texture:
        return None

    def first() -> NodeInGroups:
        """The Mapping node that is farthest from the texture; without a Mapping node, the texture."""
        now = environment(world)
        assert now
        return [now, *(way for way in _ways(now) if way.node.bl_idname == "ShaderNodeMapping")][-1]

    def entry() -> NodeEntry | None:
        """The Mapping's Rotation input, or Z of a Combine XYZ that feeds it; None if there is none, or if computed."""
        if first().node.bl_idname != "ShaderNodeMapping":
            return None
        turn = NodeEntry(first().node.inputs["Rotation"], first().inside)
        origin = resolve(turn)
        if origin.source and origin.source.node.bl_idname == "ShaderNodeCombineXYZ":
            turn = NodeEntry(origin.source.node.inputs["Z"], origin.inside)
            origin = resolve(turn)
        return None if origin.source else turn

    def find() -> ValueSlot | None:
        inner = input_slot(entry)
        if inner is None:
            return None
        # A Mapping node of type Texture turns the other way round.
        sign = -1.0 if first().node.vector_type == "TEXTURE" else 1.0
        return DerivedSlot(
            inner,
            lambda turn: sign * (turn[2] if isinstance(turn, tuple) else turn),
            lambda turn, raw: (*turn[:2], sign * raw) if isinstance(turn, tuple) else sign * raw,
        )

    def make(journal: Journal) -> ValueSlot | None:
        own_groups(journal, first().inside)
        vector = first().node.inputs["Vector"]
        tree = vector.id_data
        mapping = journal.node(tree, "ShaderNodeMapping", "Vibe Rotation")
        owned.dress(journal, tree, mapping, vector.node)
        if links := active_links(vector):
            source = links[0].from_socket
        else:
            direction = journal.node(tree, "ShaderNodeTexCoord", "Vibe Direction")
            direction.parent = mapping.parent
            direction.location = (mapping.location.x - direction.width - 60.0, mapping.location.y)
            source = direction.outputs["Generated"]
        journal.link(source, mapping.inputs["Vector"])
        journal.link(mapping.outputs["Vector"], vector)
        return find()

    return find() or LazySlot(find, make, 0.0, locks.of_socket(texture.node.inputs["Vector"], None, texture.inside))


def horizon_height(scene: Scene, world: World | None) -> float:
    """Height of a world's horizon in the image: 0 at the bottom, 1 at the top, less than 0 below the image."""
    seen = single_background(world, BACKDROP)
    color = seen.entry("Color") if seen else None
    if made := HORIZON.of(resolve(color).source) if color else None:
        return made.inputs["Height"].default_value
    # For a camera that looks down or has no perspective, the backdrop fades from the bottom.
    camera = scene.camera
    if camera is None or camera.type != "CAMERA" or camera.data.type != "PERSP":
        return 0.0
    ahead = camera.matrix_world.to_quaternion() @ Vector((0.0, 0.0, -1.0))
    level = Vector((ahead.x, ahead.y, 0.0))
    if level.length < 1e-3:
        return 0.0
    far = camera.matrix_world.translation + 1e4 * level.normalized()
    height = world_to_camera_view(scene, camera, far).y
    return max(height, -1.0) if height < 0.6 else 0.0  # a higher one: the camera looks down


def _add_backdrop(journal: Journal, world: World) -> None:
    """Adds a Background for camera rays alone, with the artist's values of the Background that lights the scene."""
    single, tree, output = single_background(world), compat.node_tree(world), compat.output_node(world)
    assert single
    assert tree
    assert output
    surface = output.inputs["Surface"]
    lighting = active_links(surface)[0].from_socket
    mix = journal.node(tree, "ShaderNodeMixShader", "Vibe Backdrop")
    owned.dress(journal, tree, mix, output)
    seen = journal.node(tree, "ShaderNodeBackground", "Vibe Backdrop Background")
    path = journal.node(tree, "ShaderNodeLightPath", "Vibe Backdrop Light Path")
    for node, rows in ((seen, 1), (path, -2)):
        node.parent, node.use_custom_color, node.color = mix.parent, True, owned.COLOR
        node.location = (mix.location.x - _LEFT, mix.location.y - rows * _LEFT)
    # The new Background starts with the artist's values of the one that lights.
    for name in ("Color", "Strength"):
        entry = single.entry(name)
        assert entry
        origin = artists_origin(entry)
        if origin.source:
            journal.link(origin.source, seen.inputs[name])
        else:
            seen.inputs[name].default_value = origin.socket.default_value
    # The camera sees the new one, everything else the old one.
    journal.link(path.outputs["Is Camera Ray"], mix.inputs[0])
    journal.link(lighting, mix.inputs[1])
    journal.link(seen.outputs[0], mix.inputs[2])
    journal.link(mix.outputs[0], surface)


def offered_backdrop(world: World | None, instances: Mapping[str, schema.Instance]) -> dict[str, schema.Instance]:
    """Key -> parameter instance that a new backdrop would have; empty if the world cannot have one, or is locked."""
    output, single = compat.output_node(world), single_background(world)
    # The world has to have one plain Background, not in a group, that both lights and is seen.
    if not (output and single) or has_backdrop(world) or single.inside or not active_links(output.inputs["Surface"]):
        return {}
    own = {key: instances[its] for key, its in WORLD_OF_BACKDROP.items() if its in instances}
    if any(instance.locked for instance in own.values()):
        return {}
    offer = {key: replace(i, parameter=schema.FAMILIES[key]) for key, i in own.items()}
    if plain := offer.get("world/backdrop_color"):
        offer[HORIZON_KEY] = replace(plain, parameter=schema.FAMILIES[HORIZON_KEY], value=NO_HORIZON)
    return offer


def with_backdrop(
    journal: Journal,
    world: World | None,
    instances: Mapping[str, schema.Instance],
    values: Mapping[str, Sequence[float]],
) -> dict[str, Sequence[float]]:
    """Adds a backdrop if `values` (by key) make it differ from the world's light; returns the values still to write."""
    offer = offered_backdrop(world, instances)
    named = [key for key in values if key in offer]
    if world is None or not named:
        return dict(values)
    future = {key: tuple(values.get(key, instance.value)) for key, instance in {**instances, **offer}.items()}
    future[""] = NO_HORIZON
    if all(labels.same(key, future[WORLD_OF_BACKDROP[key]], future[key]) for key in named):
        return {key: value for key, value in values.items() if key not in offer}  # without a backdrop
    _add_backdrop(journal, world)
    return {**{key: instance.value for key, instance in offer.items()}, **values}
