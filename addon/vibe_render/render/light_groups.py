# SPDX-License-Identifier: GPL-3.0-or-later
"""Light layers: parts of a render, each the light of one Cycles light group; and their mix, through the compositor.

Light adds up, so the layers of a render add up to its image. Sources in no light group (a linked light, emitting fog)
are only in the whole image.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import bpy
import numpy as np
from bpy.types import ID, Image, Material, Node, NodeTree, Object, Scene, ViewLayer

from ..core import compat, rendered
from ..core.compat import changed
from ..core.journal import Journal
from ..core.temporary import temporary
from ..scene import snapshot
from ..scene.copies import copied_scene
from ..scene.nodes import mix
from ..scene.nodes.layers import emitted_radiance
from ..scene.nodes.owned import is_unseen
from . import bake

MOST = 12  # maximum number of layers for lights: more sliders are hard to use, and each layer takes memory
WORLD, EMISSION, REST = "World", "Emission", "Other Lights"


@dataclass(frozen=True)
class LightLayer:
    """Sources of light that are rendered into one light group."""

    name: str  # of the light group
    members: tuple[ID, ...]  # the sources: lights, objects that glow, the world
    own: bool = False  # whether the light group is the artist's
    title: str = ""  # the name that the artist sees


def light_layers(scene: Scene) -> list[LightLayer]:
    """A layer for each light group of the artist, then for other lights, the world, and all emitting objects."""
    layer = rendered.layer(scene)
    layer.update()  # so that objects that were added just now are in it
    world = rendered.world(scene)
    sources: list[ID] = [m for m in (*all_lights(scene), world, *_glowing(scene)) if m and m.is_editable]
    names = [group.name for group in layer.lightgroups]
    theirs: dict[str, list[ID]] = {}
    others: list[ID] = []
    for source in sources:
        (theirs.setdefault(source.lightgroup, []) if source.lightgroup in names else others).append(source)
    found = [LightLayer(name, tuple(theirs[name]), True, name) for name in names if name in theirs]
    for name, members in _few([m for m in others if is_light(m)]).items():
        title = f"{name} ({len(members)})" if len(members) > 1 else name
        found.append(LightLayer(name, tuple(members), title=title))
    if world in others:
        found.append(LightLayer(WORLD, (world,), title=WORLD))
    if glowing := tuple(m for m in others if m != world and not is_light(m)):
        found.append(LightLayer(EMISSION, glowing, title=EMISSION))
    return found


def is_light(block: ID) -> bool:
    """True if a data-block is a light object."""
    return isinstance(block, Object) and block.type == "LIGHT"


def all_lights(scene: Scene) -> list[Object]:
    """The lights that a render shows, also those of instances, each once."""
    return list(dict.fromkeys([*rendered.lights(scene), *(each for each, _ in rendered.instanced_lights(scene))]))


def sharing_data(lights: Iterable[Object]) -> dict[str, list[Object]]:
    """Name of the first light -> all lights that share its light data."""
    found: dict[ID, list[Object]] = {}
    for light in lights:
        found.setdefault(light.data, []).append(light)
    return {members[0].name_full: members for members in found.values()}


def _glowing(scene: Scene) -> list[Object]:
    of = rendered.layer(scene)
    emits: dict[Material, float] = {}
    found: dict[Object, bool] = {}
    for thing, _, _ in rendered.instances(scene):
        if thing.type not in rendered.GEOMETRY or thing.original in found:
            continue
        worn = [m for m in rendered.worn(thing, of) if m]
        emits |= {m: emitted_radiance(m) for m in worn if m not in emits}
        found[thing.original] = any(emits[m] > 0.0 for m in worn) and not is_unseen(thing.original)
    return [thing for thing, glows in found.items() if glows]


def _few(lights: Sequence[Object]) -> dict[str, list[Object]]:
    """Name of a group -> lights, for at most `MOST` groups; lights that share their data are always in one group.

    If there are too many, numbered copies ("Bulb", "Bulb.001") share a group; then the faintest lights share `REST`.
    """
    groups = sharing_data(lights)
    if len(groups) <= MOST:
        return groups
    stems: dict[str, list[Object]] = {}
    for name, members in groups.items():
        stems.setdefault(re.sub(r"[._ -]*\d+$", "", name) or name, []).extend(members)
    if len(stems) <= MOST:
        return stems

    def power(name: str) -> tuple[bool, float]:
        """Sort key by brightness: suns, whose power is per square meter, count as brighter than all others."""
        return any(o.data.type == "SUN" for o in stems[name]), sum(o.data.energy for o in stems[name])

    apart = set(sorted(stems, key=power, reverse=True)[: MOST - 1])
    rest = [light for name, members in stems.items() if name not in apart for light in members]
    return {name: members for name, members in stems.items() if name in apart} | {REST: rest}


@contextmanager
def grouped(layer: ViewLayer, groups: Iterable[tuple[str, Sequence[ID]]]) -> Iterator[list[str]]:
    """For the block, puts sources of light into new light groups of a copy's view layer; yields the groups' names.

    Each item of `groups` is (proposed name, sources); Blender may number the name.
    """
    with ExitStack() as stack:
        names = []
        for wanted, members in groups:
            names.append(layer.lightgroups.add(name=wanted[:50]).name)  # a pass has at most 63 characters
            for member in members:
                stack.enter_context(changed(member, lightgroup=names[-1]))
        yield names


class LightMix:
    """The light layers of a render, in memory: their sum plus `rest` is the render.

    `layers`: light group -> (H, W, 3) float32, scene-linear, row 0 at the bottom, denoised if the render is. `rest`
    (H, W, 4): the light that is in no layer, and the alpha of the image.
    """

    def __init__(self, path: Path, view_layer: str, names: Sequence[str], size: tuple[int, int]) -> None:
        """Reads the light groups `names` from an EXR of `render_picture`, which `write` reads, too; `size`: (W, H)."""
        self._path = path
        self.layers: dict[str, np.ndarray] = {}
        passes = temporary(bpy.data.images.load(str(path)))
        with bake.empty_scene(*size) as scene, passes as image, snapshot.undone(scene) as journal:
            tree = compat.start_compositor(journal, scene)
            for node in [n for n in tree.nodes if n.bl_idname == "CompositorNodeRLayers"]:
                tree.nodes.remove(node)
            source = _image_node(tree, image, view_layer)
            denoised = "Noisy Image" in source.outputs
            whole = _rendered(scene, source, "Combined")
            noisy = _rendered(scene, source, "Noisy Image") if denoised else whole
            unnamed = noisy[..., :3].copy()
            for name in names:
                unnamed -= _rendered(scene, source, mix.PASS + name)[..., :3]
                self.layers[name] = _rendered(scene, source, mix.PASS + name, denoised)[..., :3]
        self.rest = whole
        total = np.sum([*self.layers.values(), np.zeros_like(unnamed)], 0)
        if (
            np.abs(unnamed).sum() < 1e-3 * np.abs(noisy[..., :3]).sum()
        ):  # less is a rounding error, not light in no layer
            # Each layer is denoised alone, so their sum differs a little from the denoised image: scale it to the image.
            share = np.divide(whole[..., :3], total, out=np.ones_like(total), where=total > 1e-6)
            for layer in self.layers.values():
                layer *= share
            total *= share
        self.rest[..., :3] -= total

    def mixed(self, factors: Mapping[str, Sequence[float]]) -> np.ndarray:
        """`rest` plus each layer times its factor (red, green, blue), by default 1: (H, W, 4) float32, scene-linear."""
        image = self.rest.copy()
        for name, layer in self.layers.items():
            image[..., :3] += layer * np.array(factors.get(name, (1.0, 1.0, 1.0)), np.float32)
        return np.maximum(image, 0.0, out=image)

    def write(self, scene: Scene, path: Path, factors: Mapping[str, Sequence[float]]) -> None:
        """Writes the mix as a PNG, through the scene's compositor and view transform, without a new render."""
        height, width, _ = self.rest.shape
        image = bpy.data.images.new("Vibe Mix", width, height, alpha=True, float_buffer=True, is_data=True)
        journal = Journal()
        passes = bpy.data.images.load(str(self._path))
        blocks = temporary(image, passes)
        with blocks, copied_scene(scene, graded=True, size=(width, height)) as twin, ExitStack() as stack:
            stack.callback(journal.undo)
            image.pixels.foreach_set(self.mixed(factors).ravel())
            tree = compat.compositor(twin) or compat.start_compositor(journal, twin)
            _feed(tree, image, passes, rendered.layer(scene).name)
            bake.render_file(twin, path, bake.png("RGBA"))


def _feed(tree: NodeTree, image: Image, passes: Image, first: str) -> None:
    """Replaces Render Layers by Image nodes: `image` for the image of view layer `first`, `passes` for other passes."""
    for node in list(tree.nodes):
        if node.type == "GROUP" and node.node_tree:
            node.mute = node.mute or node.node_tree.get(rendered.MARK) == mix.NAME  # `image` is mixed already
            _feed(node.node_tree, image, passes, first)
        if node.bl_idname != "CompositorNodeRLayers":
            continue
        for output in [each for each in node.outputs if each.is_linked]:
            name = "Combined" if output.name == "Image" else output.name
            is_mixed = name == "Combined" and node.layer == first
            given = _image_node(tree, image) if is_mixed else _image_node(tree, passes, node.layer)
            source = given.outputs.get("Image" if is_mixed else name)
            for link in list(output.links) if source else ():
                tree.links.new(source, link.to_socket)
        tree.nodes.remove(node)


def _image_node(tree: NodeTree, image: Image, view_layer: str = "") -> Node:
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    if view_layer:
        with suppress(TypeError):  # a layer of another scene, which the file does not have
            node.layer = view_layer
    return node


def _rendered(scene: Scene, source: Node, name: str, denoised: bool = False) -> np.ndarray:
    """A pass of an Image node, denoised if requested: (H, W, 4) float32, row 0 at the bottom."""
    tree = source.id_data
    target, output = compat.compositor_output(tree), source.outputs[name]
    assert target
    if denoised:
        node = mix.denoise_node(tree)
        for guide in ("Albedo", "Normal"):
            tree.links.new(source.outputs[f"Denoising {guide}"], node.inputs[guide])
        tree.links.new(output, node.inputs["Image"])
        output = node.outputs[0]
    tree.links.new(output, target)
    return bake.render_pixels(scene, {**bake.LINEAR, "color_mode": "RGBA"})
