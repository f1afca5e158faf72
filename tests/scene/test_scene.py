# SPDX-License-Identifier: Apache-2.0
"""Exported scenes: what is read, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from tiny_job import write_job

from proxy_renderer.optimize.scene_facts import present_looks
from proxy_renderer.scene import load_scene
from proxy_renderer.schema import VibeError


def test_reads_what_was_written(tmp_path: Path) -> None:
    scene = load_scene(write_job(tmp_path / "job"))
    assert [m.name for m in scene.materials] == ["Ball", "Floor"]
    assert scene.mesh.faces.dtype == np.int32
    assert scene.mesh.normals.shape == (len(scene.mesh.faces), 3, 3)
    assert scene.instances["light/Key/power"].value == (250.0,)
    assert scene.value("film/contrast") == (1.0,)


def _edit(folder: Path, **changes: object) -> None:
    path = folder / "scene.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))


@pytest.mark.parametrize(
    "changes",
    [{"format": 99}, {"schema": "other"}, {"resolution": [0, 4]}, {"pivot": [0, 0]}, {"lights": 3}],
    ids=lambda c: next(iter(c)),
)
def test_refuses_what_it_cannot_use(tmp_path: Path, changes: dict) -> None:
    folder = write_job(tmp_path / "job")
    _edit(folder, **changes)
    with pytest.raises(VibeError) as error:
        load_scene(folder)
    assert error.value.remedy


def test_refuses_a_panorama_and_a_broken_value(tmp_path: Path) -> None:
    folder = write_job(tmp_path / "a")
    content = json.loads((folder / "scene.json").read_text())
    _edit(folder, camera={**content["camera"], "type": "PANO"})
    with pytest.raises(VibeError, match="PANO"):
        load_scene(folder)
    folder = write_job(tmp_path / "b", **{"material/Ball/roughness": float("nan")})
    with pytest.raises(VibeError, match="Ball: Roughness"):
        load_scene(folder)


def test_refuses_missing_files(tmp_path: Path) -> None:
    with pytest.raises(VibeError, match="cannot be read"):
        load_scene(tmp_path)


def test_drops_broken_triangles_and_refuses_when_none_is_left(tmp_path: Path) -> None:
    folder = write_job(tmp_path / "job")
    with np.load(folder / "meshes.npz") as stored:
        arrays = dict(stored)
    arrays["vertices"][arrays["faces"][0, 0]] = np.nan
    arrays["normals"][5] = 0.0
    np.savez(folder / "meshes.npz", **arrays)
    mesh = load_scene(folder).mesh
    assert 0 < len(mesh.faces) < len(arrays["faces"])
    assert np.isfinite(mesh.vertices[mesh.faces]).all()
    assert np.allclose(np.linalg.norm(mesh.normals, axis=2), 1, atol=1e-3)
    np.savez(folder / "meshes.npz", **{**arrays, "vertices": arrays["vertices"] * 0})
    with pytest.raises(VibeError, match="no mesh"):
        load_scene(folder)


def _with_vertices_moved(folder: Path, by: float) -> Path:
    with np.load(folder / "meshes.npz") as stored:
        arrays = dict(stored)
    arrays["vertices"][0] += by
    np.savez(folder / "meshes.npz", **arrays)
    return folder


def test_jobs_of_one_scene_share_their_mesh_whatever_its_last_digits(tmp_path: Path) -> None:
    """Subdivision in threads rounds otherwise at each export; a mesh that has moved is another one."""
    first = load_scene(write_job(tmp_path / "first"))
    rounded = load_scene(_with_vertices_moved(write_job(tmp_path / "rounded"), 1e-7))
    moved = load_scene(_with_vertices_moved(write_job(tmp_path / "moved"), 0.01))
    assert rounded.mesh is first.mesh
    assert moved.mesh is not first.mesh


def test_a_camera_that_has_moved_sees_a_shared_mesh_anew(tmp_path: Path) -> None:
    """What is known of a mesh says nothing of the camera of a job."""
    first = load_scene(write_job(tmp_path / "first"))
    second = load_scene(write_job(tmp_path / "second", **{"camera/distance": 60.0}))
    assert second.mesh is first.mesh
    shares = [sum(look.share for look in present_looks(scene).values()) for scene in (first, second)]
    assert shares[0] > 2 * shares[1]
