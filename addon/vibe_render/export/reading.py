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
    """Adds missing parts (see `prepare_scene`) and writes the job folder (`write_job`); a failure undoes the additions.

    If `first_shot` is given, the shot takes its subject and pivot. `eyes` are the camera positions of all shots of this
    scene: one fog box encloses them.
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
    """Mutes Vibe Render's keyframes, adds missing parts (see `prepare_scene`), takes a snapshot if there is none."""
    check_scene(scene)
    keyframes.set_aside(scene)
    prepare_scene(scene, named_objects(scene, choice))
    snapshot.take(scene)


@dataclass(frozen=True)
class SceneReading:
    """A scene's analysis and, for presets, its parameters by key: less than a job, and nothing is written to disk."""

    analysis: SceneAnalysis
    instances: dict[str, schema.Instance]


def read_scene(scene: Scene, choice: SubjectChoice) -> SceneReading:
    """Reads the parameters of a scene that has a camera, without changing it; raises VibeError as `analyze`."""
    analysis = analyze(scene, choice)
    return SceneReading(analysis, read_parameters(analysis))


def prepare_and_read(scene: Scene, choice: SubjectChoice) -> SceneReading:
    """Adds missing parts (see `prepare_scene`) and reads the parameters; a failure undoes the additions."""
    with _prepared(scene, choice) as analysis:
        return SceneReading(analysis, read_parameters(analysis))


@contextmanager
def _prepared(scene: Scene, choice: SubjectChoice) -> Iterator[SceneAnalysis]:
    with snapshot.rollback_on_failure(scene):
        prepare_and_snapshot(scene, choice)
        yield analyze(scene, choice)


def sketch_scene(scene: Scene, folder: Path, choice: SubjectChoice) -> None:
    """Writes a sketch: a job folder with boxes as meshes, which can only explain words. Replaces unreadable names."""
    check_scene(scene)
    rendered.layer(scene).update()  # collections and matrices that have just changed
    camera = ray_camera(scene)
    shown = {obj for obj in rendered.shown(scene) if not owned.is_unseen(obj)}
    geometry = box_geometry(scene, shown, camera)
    visible = VisibleScene(geometry, visible_surfaces(camera, geometry), frozenset())
    write_sketch(analyze(scene, choice, visible), folder)
