# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a scene for the engine (a job folder, or a sketch of it) or for presets (its parameters)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from bpy.types import Scene
from mathutils import Vector

from ..core import rendered
from ..core.schema_import import schema
from ..scene import fog, keyframes, snapshot
from ..scene.geometry.meshes import box_geometry
from ..scene.geometry.triangles import ray_camera, visible_surfaces
from ..scene.nodes import owned
from ..scene.prepare import prepare_scene
from ..scene.subject import SubjectChoice, named_objects
from .analysis import SceneAnalysis, VisibleScene, analyze, check_scene, data_blocks, with_subject_of
from .job_folder import SceneJob, read_parameters, write_job, write_sketch


def export_scene(
    scene: Scene,
    folder: Path,
    choice: SubjectChoice,
    first_shot: SceneAnalysis | None = None,
    eyes: Sequence[Vector] = (),
    measure: bool = True,
) -> SceneJob:
    """Adds what the scene lacks and writes its job folder (see `write_job`); after a failure the scene is as it was.

    A shot takes the subject and pivot of the scene's first shot. `eyes` are the camera positions of all of its shots: one
    fog box encloses them.
    """
    with _prepared(scene, choice) as analysis:
        if eyes:
            fog.plan_fog_box(scene, fog.fog_domain(analysis.context(), eyes))
        return write_job(with_subject_of(analysis, first_shot) if first_shot else analysis, folder, measure)


def export_captured(scene: Scene, folder: Path, choice: SubjectChoice, visible: VisibleScene) -> SceneJob | None:
    """Writes the job folder of a prepared and captured scene.

    None if the camera, the snapshot, or a captured object or material has been removed since. The caller has to roll back
    after a failure. Use this after `SceneCapture.visible_scene`, which a thread can compute while Blender stays usable.
    """
    if scene.camera is None or not snapshot.exists(scene) or not visible.blocks <= data_blocks():
        return None
    return write_job(analyze(scene, choice, visible), folder)


def prepare_and_snapshot(scene: Scene, choice: SubjectChoice) -> None:
    """Mutes Vibe Render's keyframes and adds what the scene lacks; starts a snapshot, if there is none, for Revert."""
    check_scene(scene)
    keyframes.set_aside(scene)
    prepare_scene(scene, named_objects(scene, choice))
    snapshot.take(scene)


@dataclass(frozen=True)
class SceneReading:
    """A scene's parameters for presets, by key, and its analysis: less than a job, and nothing is written to disk."""

    analysis: SceneAnalysis
    instances: dict[str, schema.Instance]


def read_scene(scene: Scene, choice: SubjectChoice) -> SceneReading:
    """Reads the parameters of a scene that has a camera, without changing it; raises as `export_scene`."""
    analysis = analyze(scene, choice)
    return SceneReading(analysis, read_parameters(analysis))


def prepare_and_read(scene: Scene, choice: SubjectChoice) -> SceneReading:
    """Adds what the scene lacks and reads its parameters; fails as `export_scene`."""
    with _prepared(scene, choice) as analysis:
        return SceneReading(analysis, read_parameters(analysis))


@contextmanager
def _prepared(scene: Scene, choice: SubjectChoice) -> Iterator[SceneAnalysis]:
    """Adds what a scene lacks and yields its analysis; a failure inside the block undoes the additions."""
    with snapshot.rollback_on_failure(scene):
        prepare_and_snapshot(scene, choice)
        yield analyze(scene, choice)


def sketch_scene(scene: Scene, folder: Path, choice: SubjectChoice) -> None:
    """Writes a sketch: a job folder with bounding boxes in place of meshes, for explaining words; changes names at most."""
    check_scene(scene)
    rendered.layer(scene).update()  # collections and matrices that have just changed
    camera = ray_camera(scene)
    shown = {obj for obj in rendered.shown(scene) if not owned.is_unseen(obj)}
    geometry = box_geometry(scene, shown, camera)
    visible = VisibleScene(geometry, visible_surfaces(camera, geometry), frozenset())
    write_sketch(analyze(scene, choice, visible), folder)
