# SPDX-License-Identifier: GPL-3.0-or-later
"""A light mix of the open scene: renders and mixes the light layers, writes the mix to the scene or its compositor."""

import shutil
import uuid
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any

import bpy
from bpy.types import Scene

from ..core import rendered
from ..core.color import Color
from ..core.schema_import import schema
from ..render import bake, final_render, light_groups
from ..render.light_groups import LightLayer, LightMix
from ..scene import bindings, snapshot
from ..scene.nodes import mix
from ..scene.nodes.layers import emitted_radiance
from ..scene.steps import LIGHT_MIX, Change, Steps
from . import result

WHITE: Color = (1.0, 1.0, 1.0)
NEEDS_CYCLES = "Light Mix needs Cycles. Set the render engine to Cycles"
_SIZE, _SAMPLES = 512, 32
_POWERS = ("power", "strength", "emission")
_COLORS = ("color", "tint", "emission_color")
_BACKDROP = "backdrop_"


@dataclass(frozen=True)
class MixChannel:
    """A slider of the mix: a light layer (sources of light that are rendered together) with its values."""

    name: str  # of the light group
    title: str  # for people
    icon: str  # name of an icon of Blender
    objects: tuple[str, ...]  # names of its lights and of objects that glow
    world: bool  # True if the world is in the layer
    values: Mapping[str, schema.Values]  # powers and colors of its sources at the time of the render, by key


class RenderedMix:
    """The light layers of the scene's newest render: one channel for each."""

    def __init__(self, scene: Scene) -> None:
        """Renders the scene with Cycles; raises VibeError if the scene has no light, or the disk is full."""
        self.uid = scene.session_uid
        self._folder = Path(bpy.app.tempdir) / f"vibe-mix-{uuid.uuid4().hex[:8]}"
        self._folder.mkdir()
        self.rendered = self._folder / "rendered.png"
        self.picture = self._folder / "mix.png"  # of the present mix
        lights = self._folder / "lights.exr"
        try:
            layers = final_render.render_picture(scene, self.rendered, _SIZE, _SAMPLES, lights=lights)
            if not layers:
                raise schema.VibeError("This scene has no light to mix.", "Add a light.")
            self.channels = _channels(scene, layers)
            height, width, _ = bake.read_file(self.rendered).shape
            names = [channel.name for channel in self.channels]
            self._mix = LightMix(lights, rendered.layer(scene).name, names, (width, height))
            shutil.copyfile(self.rendered, self.picture)
        except BaseException:
            self.discard()
            raise

    def draw(self, scene: Scene, colors: Mapping[str, Color]) -> None:
        """Writes the image `picture` of the mix anew; `colors`: channel name -> factors of red, green and blue."""
        self._mix.write(scene, self.picture, colors)

    def discard(self) -> None:
        """Deletes the files of the render and of the mix."""
        shutil.rmtree(self._folder, ignore_errors=True)


def _channels(scene: Scene, layers: Sequence[LightLayer]) -> list[MixChannel]:
    instances = bindings.instances(scene, (), (0.0, 0.0, 0.0), ("light", "material", "world"), everything=True)
    worn = []  # for each layer, the names of its emitting materials
    for layer in layers:
        things = [m for m in layer.members if isinstance(m, bpy.types.Object) and not light_groups.is_light(m)]
        of = rendered.layer(scene)
        materials = {material for thing in things for material in rendered.worn(thing, of) if material}
        worn.append({material.name_full for material in materials if emitted_radiance(material) > 0.0})
    # Lights that share their data have the first one's name in keys.
    first = {light.data: light.name_full for light in reversed(light_groups.all_lights(scene))}
    layers_with = Counter(chain.from_iterable(worn))
    channels = []
    for layer, glowing in zip(layers, worn, strict=True):
        has_world = rendered.world(scene) in layer.members
        owners = {("light", first[m.data]) for m in layer.members if light_groups.is_light(m)}
        owners |= {("material", name) for name in glowing if layers_with[name] == 1}
        owners |= {("world", "")} if has_world else set()
        values = {
            key: instance.value
            for key, instance in instances.items()
            if (parts := schema.split_key(key))[:2] in owners
            and parts[2].removeprefix(_BACKDROP) in (*_POWERS, *_COLORS)
        }
        names = tuple(m.name for m in layer.members if isinstance(m, bpy.types.Object))
        icon = "WORLD" if has_world else "LIGHT" if any(map(light_groups.is_light, layer.members)) else "MATERIAL"
        channels.append(MixChannel(layer.name, layer.title, icon, names, has_world, values))
    return channels


def mixed_values(values: Mapping[str, schema.Values], color: Color) -> dict[str, tuple[float, ...]]:
    """The new values of a channel, by key, that multiply its light by `color`; `values`: its old powers and colors.

    Powers are multiplied by the color's largest component, colors by the color divided by that component.
    """
    factor = max(color)
    hue = tuple(c / factor for c in color) if factor > 0.0 else WHITE
    owners, is_power = {}, {}
    for key in values:
        group, name, kind = schema.split_key(key)
        owners[key] = group, name, kind.startswith(_BACKDROP)
        is_power[key] = kind.removeprefix(_BACKDROP) in _POWERS
    have_power = {owners[key] for key in values if is_power[key]}
    mixed = {}
    for key, value in values.items():
        if is_power[key]:
            mixed[key] = tuple(v * factor for v in value)
        else:  # an owner without power, such as a world without nodes: its color gets the whole factor
            by = hue if owners[key] in have_power else color
            mixed[key] = tuple(v * c for v, c in zip(value, by, strict=True))
    return mixed


def apply(scene: Scene, channels: Sequence[MixChannel], colors: Mapping[str, Color]) -> dict[str, str]:
    """Writes a mix into the scene's values, as a step; returns each key that was left alone -> the reason.

    `colors`: channel name -> factors of red, green and blue. Other channels stay as they are.
    """
    values: dict[str, tuple[float, ...]] = {}
    for channel in channels:
        if channel.name in colors:
            values |= mixed_values(channel.values, colors[channel.name])
    steps = Steps.of(scene)
    current = bindings.read(scene, (), steps.pivot)
    steps.take_hand_made(current)
    skipped = bindings.write(scene, values, (), steps.pivot)
    with snapshot.transaction(scene) as journal:
        mix.mute_mix(journal, scene)
    written = {key: value for key, value in values.items() if key not in skipped and key in current}
    steps.add(Change(steps, title=LIGHT_MIX), current, written, dict.fromkeys(written, "Light Mix"))
    result.show(scene, steps)
    return skipped


def write_nodes(scene: Scene, channels: Sequence[MixChannel], colors: Mapping[str, Color]) -> None:
    """Writes a mix (`colors`: as for `apply`) as compositor nodes, with their light groups; Revert removes both."""
    layer = rendered.layer(scene)
    with snapshot.transaction(scene) as journal:
        named = {}
        for channel in channels:
            color = colors.get(channel.name, WHITE)
            # the channel's lights and objects that still exist, and its world
            local: Any = ((name, None) for name in channel.objects)
            objects = [bpy.data.objects.get(name) for name in local]
            members = [m for m in (*objects, rendered.world(scene) if channel.world else None) if m]
            groups = {member.lightgroup for member in members}
            group = groups.pop() if len(groups) == 1 else ""
            if group not in layer.lightgroups:
                if color == WHITE:
                    continue
                group = journal.light_group(layer, channel.name)
                for member in members:
                    journal.set(member, "lightgroup", group)
            named[group] = color
        mix.insert_mix(journal, scene, named)
