# SPDX-License-Identifier: Apache-2.0
"""A bare mesh that cannot be rendered is refused by one clear line, before Blender is started."""

import struct
import time

import numpy as np
import pytest
import trimesh
from command_line import assert_refused, vibe

from proxy_renderer.blender import meshes
from proxy_renderer.blender.meshes import check, prepared
from proxy_renderer.schema import VibeError

FLAT = "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"
PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n1 0 0\n0 1 0\n"
NAN = struct.pack("<80xI12fH", 1, 0, 0, 1, float("nan"), 0, 0, 1, 0, 0, 0, 1, 0, 0)
FAULTS = {
    "points.obj": ("v 0 0 0\nv 1 0 0\n", "no mesh with faces"),
    "points.ply": (PLY, "no mesh with faces"),
    "flat.obj": (FLAT, "has no size"),
    "text.obj": ("hello\n", "no mesh with faces"),
    "text.glb": ("hello\n", "text.glb cannot be read"),
    "text.ply": ("hello\n", "text.ply cannot be read"),
    "short.gltf": ("{}", "short.gltf"),
    "nan.stl": (NAN, "not finite"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_each_fault_has_its_line(tmp_path, name):
    content, words = FAULTS[name]
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    trimesh.creation.box().export(tmp_path / "box.glb")
    check(tmp_path / "box.glb")  # what is imported once
    start = time.process_time()
    with pytest.raises(VibeError, match=words) as caught, prepared(path):
        pass
    assert time.process_time() - start < 1.0
    assert caught.value.remedy


def with_extension(path, name, used="extensionsRequired"):
    """A .glb of a box that names an extension."""
    trimesh.creation.box().export(path)
    document, binary = meshes.read_gltf(path)
    meshes._write(path, document | {used: [name]}, bytearray(binary))
    return path


@pytest.mark.parametrize("name", ["KHR_texture_basisu", "EXT_meshopt_compression", "ADOBE_new_one"])
def test_extensions_that_blender_does_not_read(tmp_path, name):
    scene = with_extension(tmp_path / "box.glb", name)
    with pytest.raises(VibeError, match=name) as refused, prepared(scene):
        pass
    assert refused.value.remedy.startswith("Export it again")


def test_extensions_that_can_be_left_out(tmp_path):
    with prepared(with_extension(tmp_path / "box.glb", "KHR_texture_basisu", "extensionsUsed")):
        pass
    with prepared(with_extension(tmp_path / "known.glb", "KHR_materials_unlit")):
        pass


def test_a_texture_without_another_picture(tmp_path):
    scene = tmp_path / "box.glb"
    trimesh.creation.box().export(scene)
    document, binary = meshes.read_gltf(scene)
    document["textures"] = [{"extensions": {"KHR_texture_basisu": {"source": 0}}}]
    meshes._write(scene, document, bytearray(binary))
    with pytest.raises(VibeError, match="KHR_texture_basisu"), prepared(scene):
        pass


@pytest.mark.parametrize("command", ["run", "explain"])
def test_blender_is_not_started_for_it(tmp_path, command):
    (tmp_path / "points.obj").write_text("v 0 0 0\n")
    scene, more = ("points.obj", ["--prompt=teal", "--out=out"]) if command == "run" else ("teal", ["points.obj"])
    done = vibe(command, scene, *more, cwd=tmp_path)
    assert_refused(done, "There is no mesh with faces in points.obj")
    assert "Blender" not in done.stdout


@pytest.mark.parametrize("suffix", ["obj", "ply", "stl", "glb", "gltf"])
def test_what_is_well_is_handed_on_as_it_is(tmp_path, suffix):
    path = tmp_path / f"ball.{suffix}"
    trimesh.creation.icosphere(1).export(path)
    assert path.is_file()
    with prepared(path) as place:
        assert place == path


def test_a_blend_is_left_to_blender(tmp_path):
    path = tmp_path / "shot.blend"
    path.write_text("not even a .blend")
    with prepared(path) as place:
        assert place == path


def test_a_million_triangles_cost_less_than_a_second(tmp_path):
    """Also as text: what would take longer to read than Blender to start is left to it."""
    side = np.linspace(0.0, 1.0, 708)
    points = np.stack(np.broadcast_arrays(side[:, None], side[None], 0.0), -1).reshape(-1, 3)
    corner = (np.arange(707)[:, None] * 708 + np.arange(707)).reshape(-1, 1)
    faces = np.concatenate([corner + np.array(offsets) for offsets in ((0, 1, 708), (1, 709, 708))])
    trimesh.Trimesh(points, faces, process=False).export(tmp_path / "large.ply")
    rows = "\n".join(["v 0 0 0\nv 1 0 0\nv 0 1 0", *(["f 1 2 3"] * 2_000_001)])
    (tmp_path / "large.obj").write_text(rows)
    for name in ("large.ply", "large.obj"):
        start = time.process_time()
        check(tmp_path / name)
        assert time.process_time() - start < 1.0, name
