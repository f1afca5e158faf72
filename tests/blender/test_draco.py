# SPDX-License-Identifier: Apache-2.0
"""Draco-compressed glTF is unpacked; everything but the geometry's bytes stays as it is written."""

import json

import numpy as np
import pytest
import trimesh
from command_line import assert_refused, vibe
from packed_mesh import NAME, pack
from PIL import Image

from proxy_renderer.blender import meshes
from proxy_renderer.blender.meshes import prepared


@pytest.fixture
def plain(tmp_path):
    """A .glb of a textured ball, one of its hats, and a material with an extension that trimesh does not write."""
    ball, hat = trimesh.creation.icosphere(2), trimesh.creation.box((0.5, 0.4, 0.3))
    for mesh in (ball, hat):
        picture = Image.fromarray(np.arange(48, dtype=np.uint8).reshape(4, 4, 3) * 5)
        paint = trimesh.visual.material.PBRMaterial(baseColorTexture=picture, metallicFactor=0.25)
        mesh.visual = trimesh.visual.TextureVisuals(uv=mesh.vertices[:, :2] * 0.5 + 0.5, material=paint)
        assert mesh.vertex_normals.shape == mesh.vertices.shape
    scene = trimesh.Scene()
    scene.add_geometry(ball, node_name="Ball")
    scene.add_geometry(hat, node_name="Hat", parent_node_name="Ball", transform=np.diag([1.0, 1.0, 2.0, 1.0]))
    path = tmp_path / "ball.glb"
    scene.export(path, include_normals=True)
    document, binary = meshes.read_gltf(path)
    document["materials"][0]["extensions"] = {"KHR_materials_clearcoat": {"clearcoatFactor": 0.7}}
    document["extensionsUsed"] = ["KHR_materials_clearcoat"]
    meshes._write(path, document, bytearray(binary))
    return path


@pytest.mark.parametrize("name", ["packed.glb", "packed.gltf"])
def test_it_is_unpacked(plain, name):
    packed = pack(plain, plain.parent / name)
    assert meshes.is_packed(packed)
    assert not meshes.is_packed(plain)
    with prepared(packed) as place:
        assert (place.name, place.suffix) == ("packed.glb", ".glb")
        before, after = meshes.read_gltf(plain)[0], meshes.read_gltf(place)[0]
        unpacked = trimesh.load_scene(place, process=False)
    assert not place.exists()
    for key in ("nodes", "materials", "textures", "images", "extensionsUsed"):
        assert after[key] == before[key], key
    assert NAME not in json.dumps(after)
    original = trimesh.load_scene(plain, process=False)
    assert list(unpacked.geometry) == list(original.geometry)
    for mesh, other in zip(original.geometry.values(), unpacked.geometry.values(), strict=True):
        assert (other.faces == mesh.faces).all()
        assert np.abs(other.vertices - mesh.vertices).max() < 1e-4
        assert np.abs(other.visual.uv - mesh.visual.uv).max() < 1e-3


def test_bytes_that_are_no_draco(plain):
    packed = pack(plain, plain.parent / "packed.glb")
    document, binary = meshes.read_gltf(packed)
    view = document["bufferViews"][document["meshes"][0]["primitives"][0]["extensions"][NAME]["bufferView"]]
    start = view["byteOffset"]
    broken = bytearray(binary)
    broken[start : start + view["byteLength"]] = bytes(view["byteLength"])
    meshes._write(packed, document, broken)
    done = vibe("run", packed, "--prompt=teal", "--out=out", cwd=packed.parent)
    assert_refused(done, "packed.glb cannot be decoded", "without compression")
