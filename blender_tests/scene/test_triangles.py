# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of copies of a mesh: many at once are what each is alone."""

from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from vibe_render.scene.geometry import meshes
from vibe_render.scene.geometry.triangles import PlacedMesh, SourceMesh, assembled

TURN = np.array([[0.0, -1.0, 0.0, 2.0], [1.0, 0.0, 0.0, 0.5], [0.0, 0.0, 1.5, -1.0], [0.0, 0.0, 0.0, 1.0]])
MATRICES = {
    "plain": np.eye(4),
    "turned": TURN,
    "mirrored": TURN @ np.diag([-1.0, 1.0, 1.0, 1.0]),
    "flat": np.diag([1.0, 1.0, 0.0, 1.0]),
    "nowhere": np.full((4, 4), np.nan),
    "far": np.diag([1e12, 1.0, 1.0, 1.0]),
}


@pytest.fixture
def mesh():
    """A tetrahedron with two materials, of which the second shows no surface on one face."""
    corners = np.array([0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2], np.int32)
    normals = np.random.default_rng(1).normal(size=(12, 3)).astype(np.float32)
    return SourceMesh(
        vertices=np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32),
        corners=corners,
        normals=normals / np.linalg.norm(normals, axis=1, keepdims=True),
        triangles=np.arange(12, dtype=np.int32).reshape(4, 3),
        slot=np.array([0, 1, 2, 0], np.int32),
        solid=np.array([True, True, False]),
        uvs=[(np.random.default_rng(slot).random((12, 2), np.float32), np.eye(3)) for slot in range(3)],
    )


def placed(mesh, name):
    return PlacedMesh(mesh, ("Red", "Blue", "Fog"), MATRICES[name], (name, "Instancer"))


@pytest.mark.parametrize("name", MATRICES)
def test_a_copy_among_others_is_what_it_is_alone(mesh, name):
    alone = assembled([placed(mesh, name)], [])
    together = assembled([placed(mesh, each) for each in MATRICES], [])
    numbers = [i for i, owner in enumerate(together.objects) if owner[0] == name]
    mine = np.isin(together.object, numbers)
    assert mine.sum() == len(alone.faces)
    assert set(alone.warnings) <= set(together.warnings)
    if len(alone.faces):
        np.testing.assert_array_equal(together.vertices[together.faces[mine]], alone.vertices[alone.faces])
        np.testing.assert_array_equal(together.normals[mine], alone.normals)
        np.testing.assert_array_equal(together.uvs[mine], alone.uvs)
        np.testing.assert_array_equal(together.boxes[numbers[0]], alone.boxes[0])


def test_faces_without_area_surface_or_place_are_left_out(mesh):
    counts = {name: len(assembled([placed(mesh, name)], []).faces) for name in MATRICES}
    assert counts == {"plain": 3, "turned": 3, "mirrored": 3, "flat": 1, "nowhere": 0, "far": 1}


def test_a_mirrored_copy_is_seen_from_outside(mesh):
    for name in ("turned", "mirrored"):
        scene = assembled([placed(mesh, name)], [])
        a, b, c = scene.vertices[scene.faces].transpose(1, 0, 2)
        middle = scene.vertices.mean(0)
        assert (np.einsum("fi,fi->f", np.cross(b - a, c - a), a - middle) > 0).all()


def test_a_layer_that_a_file_names_and_has_lost_reads_as_zeros():
    lost = meshes.array((), "vector", (3, 2), np.float32)
    assert lost.shape == (3, 2)
    assert not lost.any()


def test_corners_of_a_mesh_whose_attributes_a_file_does_not_list_are_read_all_the_same():
    mesh = bpy.data.meshes.new("Pyramid")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [], [(0, 1, 2), (1, 3, 2)])
    unlisted = SimpleNamespace(attributes={})
    for each in (mesh, unlisted):
        corners = meshes.attribute(each, ".corner_vert", mesh.loops, "vertex_index")
        assert corners.tolist() == [0, 1, 2, 1, 3, 2]
