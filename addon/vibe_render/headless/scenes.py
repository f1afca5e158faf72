# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the scenes that the command line names, saves copies of them; lists the shots of a vibe, which share a look."""

import argparse
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from copy import copy
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

import bpy

from ..core import compat, files, rendered
from ..core.schema_import import limits, schema
from ..export import reading
from ..export.job_folder import SceneJob
from ..scene import bindings, fog, own_keys
from ..scene.stage import DEMO_SUBJECT, build_demo, build_stage
from ..scene.steps import Change
from ..scene.subject import SubjectChoice
from .arguments import Reporter

# Fluid simulations that are switched off while a file is open, where Blender is a Python module: there they abort it or
# write caches next to the scene. Each: object's name, modifier's name, shown in the viewport, shown in renders.
_fluids: list[tuple[str, str, bool, bool]] = []


def open_scene(args: argparse.Namespace, reporter: Reporter) -> tuple[bpy.types.Scene, SubjectChoice, bool]:
    """Opens or builds the scene; returns it, its subject's choice, and True if it is a mesh file on a built stage."""
    path = Path(args.scene).expanduser().absolute() if args.scene else None
    chosen = tuple(args.subject)
    if args.command == "demo":
        reporter.stage("building the demo scene")
        return build_demo(), SubjectChoice(chosen or (DEMO_SUBJECT,)), False
    if path and path.suffix.lower() in limits.MESH_FORMATS:
        reporter.stage(f"staging {path.name}")
        return build_stage(path, args.stage), SubjectChoice(chosen, selected=not chosen), True
    if path:
        reporter.stage(f"opening {path.name}")
        open_blend(path)
    return bpy.context.scene, SubjectChoice(chosen), False


def open_blend(path: Path) -> None:
    """Opens a .blend without running its scripts; raises VibeError if it cannot.

    Where Blender is the module `bpy`, fluids are switched off first: there they would end the process or write caches.
    """
    if not path.is_file():
        raise schema.VibeError(f"There is no file {path}.", "Check the path.")
    _fluids.clear()
    try:
        with _at("load_post", _switch_off) if compat.IS_MODULE else nullcontext():
            bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ").rstrip(".")
        raise schema.VibeError(f"{path.name} cannot be opened: {reason}.", "Check that it is a .blend.") from error


def save_blend(path: Path) -> None:
    """Saves a copy of the open file: relative paths fit the copy's folder, fluids are as the artist set them."""
    # Operators evaluate the scene before and after they run, so fluids are on only while the file is written.
    try:
        with _at("save_pre", lambda: _set_fluids(True)), _at("save_post", lambda: _set_fluids(False)):
            bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, relative_remap=True, check_existing=False)
    except RuntimeError as error:
        raise files.unwritable(path, error, "Make room there, or choose another --out.") from error


@contextmanager
def _at(moment: str, act: Callable[[], None]) -> Iterator[None]:
    """Calls `act` inside the block at each event `moment` of `bpy.app.handlers`, such as "load_post"."""
    handlers = getattr(bpy.app.handlers, moment)
    handler = bpy.app.handlers.persistent(lambda *_: act())  # opening a file removes other handlers
    handlers.append(handler)
    try:
        yield
    finally:
        handlers.remove(handler)


def _switch_off() -> None:
    for obj in bpy.data.objects:
        for modifier in obj.modifiers:
            if modifier.type == "FLUID" and (modifier.show_viewport or modifier.show_render):
                _fluids.append((obj.name, modifier.name, modifier.show_viewport, modifier.show_render))
    _set_fluids(False)


def _set_fluids(shown: bool) -> None:
    for name, modifier_name, viewport, renders in _fluids:
        obj = bpy.data.objects.get(name)
        if obj and (modifier := obj.modifiers.get(modifier_name)):
            modifier.show_viewport, modifier.show_render = shown and viewport, shown and renders


@dataclass(frozen=True)
class RequestedShot:
    """A shot that the command line requests: a scene, seen by a camera, at a frame."""

    scene: str  # a file; "" for the open one
    camera: str = ""  # a name; "" for the scene's active one
    frame: int | None = None  # None for the scene's present one
    name: str = ""  # for people, such as "Close · frame 50"; "" for a single shot


class Framing:
    """Sets the camera and frame of a scene; remembers camera, frame and camera markers as they were at first."""

    def __init__(self, scene: bpy.types.Scene) -> None:
        self._scene, self._camera, self._frame = scene, scene.camera, scene.frame_current
        self._markers = [(marker, marker.camera) for marker in scene.timeline_markers]

    def show(self, name: str = "", frame: int | None = None) -> None:
        """Sets the camera, unless `name` is "", and the frame, unless None; raises VibeError for an unknown camera."""
        scene, camera = self._scene, self._scene.objects.get(name)
        if name and (camera is None or camera.type != "CAMERA"):
            cameras = ", ".join(sorted(o.name for o in scene.objects if o.type == "CAMERA")) or "none"
            file = Path(bpy.data.filepath).name or "this scene"
            raise schema.VibeError(f"There is no camera {name!r} in {file}.", f"There are: {cameras}.")
        if name:
            for marker, _ in self._markers:  # markers would choose the camera at this frame
                marker.camera = None
        if frame is not None:
            scene.frame_set(frame)
        if name:
            scene.camera = camera

    def restore(self) -> None:
        """Sets camera, frame and camera markers as they were at first."""
        for marker, camera in self._markers:
            marker.camera = camera
        if self._scene.frame_current != self._frame:
            self._scene.frame_set(self._frame)
        if self._camera is not None:  # else the camera was added by us, and stays
            self._scene.camera = self._camera


class ShotList:
    """The shots of a command line: every scene, through each camera, at each frame. One shot is open at a time.

    `folder` gets the job folders. `change.values` are written into each scene that is opened.
    """

    def __init__(self, args: argparse.Namespace, folder: Path, reporter: Reporter, change: Change) -> None:
        self._args, self._folder, self._reporter, self._change = args, folder, reporter, change
        self.shots: list[RequestedShot] = []  # those of the same .blend are next to each other
        for scene, camera, frame in product(args.scenes, args.cameras or [""], args.frames or [None]):
            stem = Path(scene).stem if len(args.scenes) > 1 else ""
            moment = "" if frame is None else f"frame {frame}"
            self.shots.append(RequestedShot(scene, camera, frame, " · ".join(filter(None, (stem, camera, moment)))))
        if len(self.shots) == 1:
            self.shots = [replace(self.shots[0], name="")]
        self.jobs: list[SceneJob] = []  # the exported job of each shot
        self.subjects: list[set[str]] = []  # for each shot, the names of the objects of its subject
        self.bare = False  # True if the first shot is a mesh file, not a .blend
        self.choice = SubjectChoice()  # how the subject of the open scene is chosen
        self._open: str | None = None  # file of the open scene; None before the first
        self._framing: Framing | None = None
        self._fog: dict[str, fog.FogDomain] = {}

    def __len__(self) -> int:
        return len(self.shots)

    def siblings(self, number: int) -> list[int]:
        """The numbers of all shots of this shot's .blend, its own included."""
        return [i for i, shot in enumerate(self.shots) if shot.scene == self.shots[number].scene]

    def export(self) -> None:
        """Exports every shot to a job folder; fills `jobs` and `subjects`."""
        for number, shot in enumerate(self.shots):
            scene, choice = self._shown(number)
            first = self.siblings(number)[0]
            around = self.jobs[first].analysis if first < number else None
            # The fog box of several shots of a .blend is around all of their camera positions.
            eyes = []
            if around is None and scene.camera and len(self.siblings(number)) > 1:
                for each in reversed(self.siblings(number)):  # backwards: the first shot is the one that stays set
                    self._shown(each)
                    rendered.layer(scene).update()
                    eyes.append(scene.camera.matrix_world.translation.copy())
            folder = self._folder / str(number)
            self._reporter.stage("reading the scene")
            job = reading.export_scene(scene, folder, choice, around, eyes)
            self.jobs.append(job)
            for line in job.view_notes:
                self._reporter.note(line)
            if fluids := ", ".join(dict.fromkeys(f'"{name}"' for name, *_ in _fluids)):
                note = f"The fluid simulation of {fluids} is left out of the pictures: vibe it inside Blender."
                job.warnings.insert(0, note)
                self._reporter.note(note)
            self.subjects.append({o.name_full for o in job.analysis.objects})
            if planned := fog.planned_fog_box(scene):
                self._fog[shot.scene] = planned

    def show(self, number: int) -> SceneJob:
        """Sets a shot's camera and frame, and returns its job; opens and prepares its .blend if it is not open."""
        shot = self.shots[number]
        is_open = self._open == shot.scene
        scene, choice = self._shown(number)
        if not is_open:
            if shot.scene in self._fog:
                fog.plan_fog_box(scene, self._fog[shot.scene])
            reading.prepare_and_snapshot(scene, choice)
            for each in self.siblings(number):
                objects = tuple(o for o in scene.objects if o.name_full in self.subjects[each])
                analysis = replace(self.jobs[each].analysis, scene=scene, objects=objects)
                self.jobs[each] = replace(self.jobs[each], analysis=analysis)
        return self.jobs[number]

    def restore(self) -> None:
        """Restores the artist's camera, frame and markers in the open scene."""
        assert self._framing is not None
        self._framing.restore()

    def _shown(self, number: int) -> tuple[bpy.types.Scene, SubjectChoice]:
        """Opens a shot's .blend if necessary, sets camera and frame; returns the scene and its subject's choice."""
        shot = self.shots[number]
        opens = self._framing is None or self._open != shot.scene
        if opens:
            args = copy(self._args)
            args.scene = shot.scene
            scene, self.choice, bare = open_scene(args, self._reporter)
            self._open, self._framing = shot.scene, Framing(scene)
            self.bare = self.bare or (bare and not self.jobs)
            if self._change.values:
                bindings.write(scene, self._change.values, (), self._change.steps.pivot)
        assert self._framing is not None
        self._framing.show(shot.camera, shot.frame)
        if opens and self._args.offset_keys:
            own_keys.hold(bpy.context.scene)
        return bpy.context.scene, self.choice
