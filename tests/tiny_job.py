# SPDX-License-Identifier: Apache-2.0
"""A small real scene as a job folder: a gray ball on a gray floor, a lamp, a sun, a plain world."""

import importlib.util
import json
from pathlib import Path

import numpy as np
import trimesh

from proxy_renderer.schema import PARAMETERS, Instance, orbit, schema_hash

KEY_LIGHT = {"azimuth": -35.0, "elevation": 40.0, "distance": 4.0, "power": 250.0, "size": 0.6}
IDENTITY = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]


def blender_config() -> str:
    """Blender's color configuration, found without importing bpy."""
    origin = importlib.util.find_spec("bpy").origin
    return str(next(Path(origin).parent.glob("*/datafiles/colormanagement/config.ocio")))


def write_job(folder: Path, **values) -> Path:
    """Writes the folder; `values` replace parameters: {"film/contrast": 1.2} as keywords of a dict."""
    folder.mkdir(parents=True, exist_ok=True)
    _write_meshes(folder)
    content = {
        "format": 1,
        "schema": schema_hash(),
        "blender": "5.2",
        "source": "",
        "resolution": [64, 48],
        "pixel_aspect": 1.0,
        "pivot": [0.0, 0.0, 1.0],
        "references": {
            "view_distance": 6.0,
            "per_view_distance": 1 / 6,
            "subject_height": 2.0,
            "per_subject_height": 0.5,
        },
        "camera": {
            "name": "Camera",
            "type": "PERSP",
            "residual": IDENTITY,
            "ortho_scale": 6.0,
            "shift": [0, 0],
            "sensor_fit": "AUTO",
            "clip": [0.01, 1000.0],
        },
        "lights": [
            {"name": "Key", "type": "AREA", "residual": IDENTITY, "position": _position(), "role": "key"},
            {"name": "Sun", "type": "SUN", "residual": IDENTITY, "position": [0, 0, 5], "role": "fill"},
        ],
        "materials": [{"name": "Ball", "role": "subject"}, {"name": "Floor", "role": "surroundings"}],
        "objects": [{"name": "Ball", "subject": True}, {"name": "Floor", "subject": False}],
        "world": {"kind": "color"},
        "volume": {"kind": "none", "center": [0, 0, 3], "half_size": [8, 8, 4], "base": 0.0},
        "film": {
            "ocio": blender_config(),
            "display": "sRGB",
            "view": "AgX",
            "look": "",
            "transparent": False,
            "working_space": "Linear Rec.709",
        },
        "parameters": {**_parameters(), **{k: {"value": v} for k, v in values.items()}},
    }
    (folder / "scene.json").write_text(json.dumps(content))
    return folder


def _write_meshes(folder: Path) -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    vertices = np.concatenate([np.add(ball.vertices, [0, 0, 1]), [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]]])
    count = len(ball.vertices)
    faces = np.concatenate([ball.faces, [[count, count + 1, count + 2], [count, count + 2, count + 3]]])
    normals = np.concatenate([ball.vertices[ball.faces], np.tile([0.0, 0.0, 1.0], (2, 3, 1))])
    owner = np.repeat([0, 1], [len(ball.faces), 2])
    np.savez(
        folder / "meshes.npz",
        vertices=vertices.astype(np.float32),
        faces=faces.astype(np.int32),
        normals=normals.astype(np.float32),
        uvs=np.zeros((len(faces), 3, 2), np.float32),
        material=owner.astype(np.int32),
        object=owner.astype(np.int32),
    )


def _position() -> list[float]:
    toward = orbit.direction(KEY_LIGHT["azimuth"], KEY_LIGHT["elevation"])
    return [KEY_LIGHT["distance"] * x + p for x, p in zip(toward, (0.0, 0.0, 1.0), strict=True)]


def _parameters() -> dict[str, dict]:
    owners = {
        "light": [("Key", "AREA", "key"), ("Sun", "SUN", "fill")],
        "material": [("Ball", "", "subject"), ("Floor", "", "surroundings")],
    }
    known = {
        ("camera", "distance"): 6.0,
        ("camera", "elevation"): 12.0,
        ("light", "strength"): 0.5,
        ("world", "strength"): 0.3,
        ("world", "color"): 0.5,
    }
    lengths = {
        "light_distance": 4.0,
        "light_distance_squared": 16.0,
        "view_distance": 6.0,
        "per_view_distance": 1 / 6,
        "subject_height": 2.0,
        "per_subject_height": 0.5,
    }
    rows = {}
    for p in PARAMETERS:
        if p.name in ("tint", "recolor", "rotation") or p.name.startswith("backdrop"):
            continue  # for linked textures and environments, of which there are none
        for owner, kind, role in owners.get(p.group, [("", "", "")]):
            if p.only and kind not in p.only:
                continue
            value = KEY_LIGHT.get(p.name) if owner == "Key" else None
            value = known.get((p.group, p.name), p.default) if value is None else value
            if p.name == "base_color":
                value = 0.4 if owner == "Floor" else 0.5
            instance = Instance(p, owner, (value,) * p.components)
            reference = lengths.get(p.reference, 1.0)
            rows[instance.key] = {
                "value": list(instance.value) if p.components > 1 else value,
                "reference": reference,
                "role": role,
                "locked": "",
            }
    return rows
