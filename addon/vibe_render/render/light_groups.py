# SPDX-License-Identifier: GPL-3.0-or-later
"""Light layers: which lights of a scene are rendered together into a pass of their own, by Cycles' light groups.

Light adds up, so the layers of a render add up to its image. What is in no group (a linked light, glowing fog) is only
in the whole.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, replace

import bpy
from bpy.types import ID, Object, Scene, ViewLayer

from ..core import rendered
from ..core.compat import changed
from ..scene.nodes.layers import emitted_radiance
from ..scene.nodes.owned import is_unseen

MOST = 12
"""The most layers of lights: more are more sliders than one mixes by, and each layer takes memory."""
WORLD, EMISSION, REST = "World", "Emission", "Other Lights"


@dataclass(frozen=True)
class LightLayer:
    """Sources of light that are rendered together."""

    name: str  # of its light group
    members: tuple[ID, ...]  # lights, objects that glow, the world
    own: bool = False  # whether the light group is the artist's
    title: str = ""  # for people


def light_layers(scene: Scene) -> list[LightLayer]:
    """The layers of a scene: the artist's light groups, then the other lights, the world and all emitting materials.

    Lights that share their data are in one layer. Of more lights than `MOST`, numbered copies ("Bulb", "Bulb.001") are
    in one layer, and then the faintest.
    """
    layer = rendered.layer(scene)
    layer.update()  # what was added just now is a member then
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
    """The lights that a render shows, those of instances too, each once."""
    return list(
        dict.fromkeys([*rendered.lights(scene), *(each for each, _ in rendered.instanced_lights(scene))])
    )


def sharing_data(lights: Iterable[Object]) -> dict[str, list[Object]]:
    """Lights that share their data, by the name of the first."""
    found: dict[ID, list[Object]] = {}
    for light in lights:
        found.setdefault(light.data, []).append(light)
    return {members[0].name_full: members for members in found.values()}


def _glowing(scene: Scene) -> list[Object]:
    of = rendered.layer(scene)
    emits: dict[bpy.types.Material, float] = {}
    found: dict[Object, bool] = {}
    for thing, _, _ in rendered.instances(scene):
        if thing.type not in rendered.GEOMETRY or thing.original in found:
            continue
        worn = [m for m in rendered.worn(thing, of) if m]
        emits |= {m: emitted_radiance(m) for m in worn if m not in emits}
        found[thing.original] = any(emits[m] > 0.0 for m in worn) and not is_unseen(thing.original)
    return [thing for thing, glows in found.items() if glows]


def _few(lights: Sequence[Object]) -> dict[str, list[Object]]:
    groups = sharing_data(lights)
    if len(groups) <= MOST:
        return groups
    stems: dict[str, list[Object]] = {}
    for name, members in groups.items():
        stems.setdefault(re.sub(r"[._ -]*\d+$", "", name) or name, []).extend(members)
    if len(stems) <= MOST:
        return stems

    def power(name: str) -> tuple[bool, float]:
        """A sun's is per square meter: it counts before all others."""
        return any(o.data.type == "SUN" for o in stems[name]), sum(o.data.energy for o in stems[name])

    apart = set(sorted(stems, key=power, reverse=True)[: MOST - 1])
    rest = [light for name, members in stems.items() if name not in apart for light in members]
    return {name: members for name, members in stems.items() if name in apart} | {REST: rest}


@contextmanager
def grouped(layer: ViewLayer, groups: Iterable[tuple[str, Sequence[ID]]]) -> Iterator[list[str]]:
    """Puts sources of light into new light groups of a copied scene, within the block; yields their names."""
    with ExitStack() as stack:
        names = []
        for wanted, members in groups:
            names.append(layer.lightgroups.add(name=wanted[:50]).name)  # a pass has at most 63 characters
            for member in members:
                stack.enter_context(changed(member, lightgroup=names[-1]))
        yield names


@contextmanager
def apart(scene: Scene, layer: ViewLayer) -> Iterator[list[LightLayer]]:
    """The layers of a scene as light groups of a copy's view layer, each named as its group, within the block."""
    layers = light_layers(scene)
    new = [each for each in layers if not each.own]
    with grouped(layer, [(each.name, each.members) for each in new]) as names:
        own = [each for each in layers if each.own]
        yield own + [replace(each, name=name) for name, each in zip(names, new, strict=True)]
