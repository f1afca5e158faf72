# SPDX-License-Identifier: GPL-3.0-or-later
"""Values as a vibe brings them, written without an engine, and what an artist sees of them."""

import bpy
from dump import contents
from vibe_render.scene import bindings, prepare, snapshot

PROMPT = "glossy red cube, warm light, thick fog"
FOUND = {
    "light/Area/power": [7.0],
    "light/Sun/color": [1.0, 0.5, 0.2],
    "material/Body/base_color": [0.6, 0.05, 0.05],
    "material/Body/roughness": [0.1],
    "volume/density": [0.05],
    "film/contrast": [1.3],
}
PIVOT = (0.0, 0.0, 0.5)


def read(scene):
    """The values of what FOUND names."""
    there = bindings.read(scene, (), PIVOT)
    return {key: list(there[key]) for key in FOUND if key in there}


def vibe(scene, subject, level=0.6):
    """Prepares a scene and moves every value it has."""
    prepare.prepare_scene(scene, subject)
    found = bindings.instances(scene, subject, PIVOT)
    values = {
        key: tuple((1.0 - level) * a + level * b for a, b in zip(i.lower, i.upper, strict=True))
        for key, i in found.items()
    }
    rest = bindings.write(scene, values, subject, PIVOT)
    assert all(found[key].locked for key in rest)


def state():
    """What an artist sees: the scene, what changed, and whether there is a way back."""
    scene = bpy.context.scene
    counted = (".is_runtime_data", ".users")  # Blender's own counting, which any undo turns
    seen = {k: v for k, v in contents().items() if not k.endswith(counted)}
    seen["changes"] = [(c.name, tuple(c.before), tuple(c.after)) for c in scene.vibe.changes]
    return seen | {"vibed": (snapshot.exists(scene), scene.vibe.vibed_preset)}
