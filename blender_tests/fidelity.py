# SPDX-License-Identifier: GPL-3.0-or-later
"""How near the proxy is to Cycles: lights × fogs on one scene, mean CIEDE2000, and a contact sheet.

    python blender_tests/fidelity.py DIR [SIZE [SAMPLES]]      (needs the bpy package)

Each column is a case; its rows are Cycles, the proxy, and their difference (white is 20 or more).
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np
import torch
from mathutils import Vector
from PIL import Image
from vibe_render import bindings, rendering, scene_io
from vibe_render.subject import Choice

from proxy_renderer.render import color
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene

Place = tuple[float, float, float]
_AIM: Place = (0.0, 0.0, 1.0)
_CAMERA: Place = (1.5, -7.0, 2.2)


@dataclass(frozen=True)
class Case:
    """One scene to compare.

    Attributes:
        name: For the report.
        lamps: (type, power or strength, place, other properties), all aimed at the subject.
        world: Color of the background.
        values: Parameters to write, by key.
        view: The view transform.
    """

    name: str
    lamps: Sequence[tuple[str, float, Place, Mapping[str, float]]]
    world: tuple[float, float, float]
    values: Mapping[str, Sequence[float]] = field(default_factory=dict)
    view: str = "AgX"


_LIGHTS = {
    "area": ([("AREA", 400.0, (3.0, -3.0, 4.0), {"size": 1.0})], (0.05, 0.06, 0.08)),
    "sun": ([("SUN", 3.0, (3.0, -3.0, 5.0), {"angle": 0.05})], (0.2, 0.25, 0.35)),
    "spot": (
        [("SPOT", 1500.0, (-3.0, 2.0, 5.0), {"spot_size": 0.9, "shadow_soft_size": 0.1})],
        (0.02, 0.02, 0.03),
    ),
    "point": ([("POINT", 300.0, (-1.5, -2.0, 2.5), {"shadow_soft_size": 0.2})], (0.05, 0.05, 0.05)),
    "world": ([], (0.5, 0.55, 0.65)),
}
_FOGS: dict[str, dict[str, list[float]]] = {
    "clear": {},
    "thin": {"density": [0.04]},
    "fog": {"density": [0.12], "color": [0.8, 0.85, 0.9]},
    "thick": {"density": [0.4], "color": [0.5, 0.7, 0.9], "anisotropy": [0.4]},
    "low": {"density": [0.5], "falloff": [1.0], "offset": [0.3]},
}
CASES = {
    f"{light} {fog}": Case(
        f"{light} {fog}", lamps, world, {f"volume/{name}": v for name, v in values.items()}
    )
    for light, (lamps, world) in _LIGHTS.items()
    for fog, values in _FOGS.items()
}


@dataclass(frozen=True)
class Comparison:
    """Two pictures (H, W, 3) in [0, 1], and their CIEDE2000 (H, W)."""

    cycles: torch.Tensor
    proxy: torch.Tensor
    difference: torch.Tensor

    @property
    def column(self) -> torch.Tensor:
        """(3 H, W, 3) for a contact sheet."""
        error = (self.difference / 20).clamp(0, 1)[..., None].expand_as(self.cycles)
        return torch.cat((self.cycles, self.proxy, error))


def compare(case: Case, folder: Path, size: int, samples: int) -> Comparison:
    """Builds a case in an empty file, exports it, and renders it with both."""
    scene = _build(case)
    subject, pivot = scene_io.export(scene, folder, Choice())
    if case.values:
        bindings.write(scene, {key: np.array(value) for key, value in case.values.items()}, subject, pivot)
    rendering.render(scene, folder / "cycles.png", size, samples)
    with Image.open(folder / "cycles.png") as picture:
        cycles = torch.from_numpy(np.array(picture.convert("RGB"), dtype=np.float32) / 255)
    values = {key: torch.tensor(value, dtype=torch.float32) for key, value in case.values.items()}
    with torch.no_grad():
        proxy = Proxy(load_scene(folder), (cycles.shape[1], cycles.shape[0])).render(values).display
    return Comparison(cycles, proxy, color.ciede2000(color.srgb_to_lab(cycles), color.srgb_to_lab(proxy)))


def _build(case: Case) -> bpy.types.Scene:
    """A head on a floor, a post behind it, and the case's lights."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.view_settings.view_transform = case.view
    scene.render.resolution_x = scene.render.resolution_y = 256
    bpy.ops.mesh.primitive_plane_add(size=30)
    _paint("Floor", (0.5, 0.45, 0.4), 0.7)
    bpy.ops.mesh.primitive_monkey_add(size=2, location=_AIM)
    bpy.context.object.modifiers.new("Smooth", "SUBSURF").levels = 2
    bpy.ops.object.shade_smooth()
    _paint("Head", (0.6, 0.2, 0.1), 0.4)
    bpy.ops.mesh.primitive_cylinder_add(radius=0.4, depth=3, location=(-2, 3, 1.5))
    _paint("Post", (0.2, 0.3, 0.6), 0.5)
    scene.camera = _place("Camera", bpy.data.cameras.new("Camera"), _CAMERA)
    for kind, energy, place, properties in case.lamps:
        lamp = bpy.data.lights.new(kind.title(), kind)
        lamp.energy = energy
        for name, value in properties.items():
            setattr(lamp, name, value)
        _place(kind.title(), lamp, place)
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (*case.world, 1.0)
    return scene


def _paint(name: str, base: tuple[float, float, float], roughness: float) -> None:
    """Names the active object and gives it a material."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    inputs = material.node_tree.nodes["Principled BSDF"].inputs
    inputs["Base Color"].default_value, inputs["Roughness"].default_value = (*base, 1.0), roughness
    bpy.context.object.name = name
    bpy.context.object.data.materials.append(material)


def _place(name: str, data: bpy.types.ID, place: Place) -> bpy.types.Object:
    """Puts a lamp or camera somewhere, aimed at the subject."""
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    thing.location = place
    thing.rotation_euler = (Vector(place) - Vector(_AIM)).to_track_quat("Z", "Y").to_euler()
    return thing


def main(out: Path, size: int = 128, samples: int = 256) -> None:
    """Compares all cases; writes `results.json` and `fidelity.png`."""
    results, columns = {}, []
    for name, case in CASES.items():
        found = compare(case, out / name.replace(" ", "_"), size, samples)
        results[name] = round(found.difference.mean().item(), 3)
        columns.append(found.column)
        print(f"{name}: {results[name]}", flush=True)
    results["mean"] = round(sum(results.values()) / len(results), 3)
    rows = [torch.cat(columns[i : i + len(_FOGS)], 1) for i in range(0, len(columns), len(_FOGS))]
    Image.fromarray((torch.cat(rows) * 255).byte().numpy()).save(out / "fidelity.png")
    (out / "results.json").write_text(
        json.dumps({"delta_e": results, "size": size, "samples": samples}, indent=1)
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]), *(int(a) for a in sys.argv[2:]))
