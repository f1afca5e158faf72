# SPDX-License-Identifier: GPL-3.0-or-later
"""The Backgrounds of a world. The camera may see some and get light from others: "backdrop" and "light" parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from bpy.types import Node, NodeSocket, World

from ...core import compat, locks
from ...core.journal import Journal
from ...core.schema_import import labels, schema
from ...core.value_slots import LazySlot, PropertySlot, ValueSlot
from . import owned, trails
from .inputs import artists_origin
from .layers import Layer, MixSide, behind
from .trails import (
    NodeEntry,
    NodeInGroups,
    active_links,
    depends_on_rays,
    first_background,
    resolve,
)

LIGHT, BACKDROP = "light", "backdrop"
_ROTATION = "Vibe Rotation"
_LEFT = 200.0  # from a node of ours to the next
WORLD_OF_BACKDROP = {f"world/backdrop_{name}": f"world/{name}" for name in ("color", "tint", "strength")}
"""The parameters of a backdrop, and those of the world that it starts from."""


def has_backdrop(world: World) -> bool:
    """Whether Mix Shaders by Is Camera Ray show the camera other Backgrounds than those that light the scene."""
    ways = {_seen_by_camera(layer) for layer in _world_layers(world)}
    return ways == {True, False}


def mixed_backgrounds(world: World, part: str = LIGHT) -> list[Layer]:
    """The Backgrounds that a part of a world's surface is mixed of; none where it is a single, plain one.

    One whose strength nodes compute, or whose color depends on the kind of ray, counts as a mix.

    Args:
        part: LIGHT or BACKDROP; of a world without a backdrop of its own everything is LIGHT.
    """
    found = _layers_of_part(world, part)
    return found if len(found) > 1 or any(_is_mix(layer) for layer in found) else []


def single_background(world: World, part: str = LIGHT) -> NodeInGroups | None:
    """The only Background of a part of a world; None where it is mixed, or where there is none."""
    if part == BACKDROP or has_backdrop(world):
        found = _layers_of_part(world, part)
        return found[0].shader if len(found) == 1 and not mixed_backgrounds(world, part) else None
    return None if mixed_backgrounds(world) else first_background(world)


def mixed_entries(world: World, part: str, name: str) -> list[NodeEntry]:
    """An input of each of a part's mixed Backgrounds; those whose value has one origin once."""
    layers = mixed_backgrounds(world, part)
    alike = tuple(s for layer in layers if (s := layer.shader.input(name)))
    found: list[NodeEntry] = []
    origins: list[NodeSocket] = []
    for layer in layers:
        entry = layer.shader.entry(name, alike)
        if entry is None:
            continue
        origin = resolve(entry)
        if (origin.source or origin.socket) not in origins:
            origins.append(origin.source or origin.socket)
            found.append(entry)
    return found


def shares_picture(world: World) -> bool:
    """Whether backdrop and light have their colors from the same output: one texture."""
    parts = [single_background(world, part) for part in (LIGHT, BACKDROP)]
    colors = [background.entry("Color") for background in parts if background]
    sources = [artists_origin(color).source for color in colors if color]
    return len(sources) == 2 and sources[0] is not None and sources[0] == sources[1]


def _is_mix(layer: Layer) -> bool:
    """Whether a Background is more than a color and a strength."""
    color, strength = layer.shader.entry("Color"), layer.shader.entry("Strength")
    computed = strength is not None and artists_origin(strength).source is not None
    return computed or (color is not None and depends_on_rays(color)) or any(map(_weighs, layer.sides))


def _world_layers(world: World) -> list[Layer]:
    tree = compat.node_tree(world)
    output = tree.get_output_node("ALL") if tree else None
    return list(behind(output.inputs["Surface"])) if output else []


def _layers_of_part(world: World, part: str) -> list[Layer]:
    layers = _world_layers(world)
    if not has_backdrop(world):
        return layers if part == LIGHT else []
    return [layer for layer in layers if _seen_by_camera(layer) == (part == BACKDROP)]


def _seen_by_camera(layer: Layer) -> bool | None:
    """Whether a Background is for camera rays alone, or for all others; None if it is for both."""
    ways = [side.second for side in layer.sides if not _weighs(side)]
    return ways[0] if ways else None


def _weighs(side: MixSide) -> bool:
    """Whether a side of a Mix Shader is a share, and not one kind of rays."""
    source = resolve(side.factor).source
    return not (source and source.node.type == "LIGHT_PATH" and source.name == "Is Camera Ray")


@dataclass
class _EnvironmentTurnSlot:
    """Value slot: the angle by which the looked-up direction is turned, radians.

    A Mapping node of type Texture turns the other way round.
    """

    mapping: Node

    @property
    def locked(self) -> str:
        origin = resolve(NodeEntry(self.mapping.inputs["Rotation"]))
        return locks.of_socket(origin.socket, origin.source)

    @property
    def _sign(self) -> float:
        return -1.0 if self.mapping.vector_type == "TEXTURE" else 1.0

    def get(self) -> float:
        return self._sign * self.mapping.inputs["Rotation"].default_value[2]

    def set(self, journal: Journal, raw: float) -> None:
        PropertySlot(self.mapping.inputs["Rotation"], "default_value", index=2).set(journal, self._sign * raw)


def rotation_slot(background: trails.NodeInGroups) -> ValueSlot | None:
    """The rotation of the environment texture that a background comes from; None without one."""
    texture = trails.environment_texture(background.node.inputs["Color"])
    if not texture:
        return None
    vector = texture.node.inputs["Vector"]

    def find() -> ValueSlot | None:
        links = active_links(vector)
        node = links[0].from_node if links else None
        return _EnvironmentTurnSlot(node) if node and node.bl_idname == "ShaderNodeMapping" else None

    def make(journal: Journal) -> ValueSlot:
        tree = vector.id_data
        mapping = journal.node(tree, "ShaderNodeMapping", _ROTATION)
        owned.dress(journal, tree, mapping, texture.node)
        if links := active_links(vector):
            source = links[0].from_socket
        else:
            direction = journal.node(tree, "ShaderNodeTexCoord", "Vibe Direction")
            direction.parent = mapping.parent
            direction.location = (mapping.location.x - direction.width - 60.0, mapping.location.y)
            source = direction.outputs["Generated"]
        journal.link(source, mapping.inputs["Vector"])
        journal.link(mapping.outputs["Vector"], vector)
        return _EnvironmentTurnSlot(mapping)

    existing = find()
    return existing or LazySlot(find, make, 0.0, locks.of_socket(vector, None))


def _can_have_backdrop(world: World) -> bool:
    """Whether a world is one plain Background, in its own tree, that both lights and is seen."""
    tree = compat.node_tree(world)
    output = tree.get_output_node("ALL") if tree else None
    single = single_background(world)
    if output is None or single is None or has_backdrop(world):
        return False
    return not single.inside and bool(active_links(output.inputs["Surface"]))


def _add_backdrop(journal: Journal, world: World) -> None:
    """Gives a world that allows it a Background for the camera alone, equal to the one that lights but without our insets."""
    single = single_background(world)
    tree = compat.node_tree(world)
    assert single
    assert tree
    output = tree.get_output_node("ALL")
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


def offered_backdrop(
    world: World | None, instances: Mapping[str, schema.Instance]
) -> dict[str, schema.Instance]:
    """The parameters that a backdrop would have; none where the world cannot have one, or is partly locked."""
    if world is None or not _can_have_backdrop(world):
        return {}
    own = {key: instances[its] for key, its in WORLD_OF_BACKDROP.items() if its in instances}
    if any(instance.locked for instance in own.values()):
        return {}
    return {key: replace(i, parameter=schema.FAMILIES[key]) for key, i in own.items()}


def with_backdrop(
    journal: Journal,
    world: World | None,
    instances: Mapping[str, schema.Instance],
    values: Mapping[str, Sequence[float]],
) -> dict[str, Sequence[float]]:
    """Adds a backdrop if values (by key, of anything) make it differ from the world.

    Returns:
        The values to write: without those of a backdrop that equals the world; with all of a new one.
    """
    offer = offered_backdrop(world, instances)
    named = [key for key in values if key in offer]
    if world is None or not named:
        return dict(values)
    future = {key: tuple(values.get(key, instance.value)) for key, instance in {**instances, **offer}.items()}
    if all(labels.same(key, future[WORLD_OF_BACKDROP[key]], future[key]) for key in named):
        return {key: value for key, value in values.items() if key not in offer}
    _add_backdrop(journal, world)
    return {**{key: instance.value for key, instance in offer.items()}, **values}
