# SPDX-License-Identifier: GPL-3.0-or-later
"""The Backgrounds that a world is mixed of. The camera may see some and get light from others: "backdrop" and "light"."""

from __future__ import annotations

from bpy.types import NodeSocket, World

from ...core import compat
from .insets import artists
from .layers import Layer, MixSide, behind
from .shaders import NodeInGroups, asks_for_rays
from .shaders import background as first_background
from .trails import NodeEntry, resolve

LIGHT, BACKDROP = "light", "backdrop"


def has_backdrop(world: World) -> bool:
    """Whether what the camera sees and what lights are Backgrounds of their own: Mix Shaders by Is Camera Ray part them."""
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
    """Whether what the camera sees and what lights have their colors from the same output: one texture."""
    parts = [single_background(world, part) for part in (LIGHT, BACKDROP)]
    colors = [background.entry("Color") for background in parts if background]
    sources = [artists(color).source for color in colors if color]
    return len(sources) == 2 and sources[0] is not None and sources[0] == sources[1]


def _is_mix(layer: Layer) -> bool:
    """Whether a Background is more than a color and a strength."""
    color, strength = layer.shader.entry("Color"), layer.shader.entry("Strength")
    computed = strength is not None and artists(strength).source is not None
    return computed or (color is not None and asks_for_rays(color)) or any(map(_weighs, layer.sides))


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
