# SPDX-License-Identifier: GPL-3.0-or-later
"""The base of a vibe and of Live: a scene that is read, and a look that is shown in it."""

from __future__ import annotations

import shutil
import uuid
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import bpy

from ..core.schema_import import messages, schema
from ..engine.process import Engine
from ..export import reading
from ..render import reference
from ..scene import keyframes, snapshot
from . import preview
from .driver import Driver

READING = "Reading the scene"


def scene_settings(scene: bpy.types.Scene) -> tuple[Any, ...]:
    """The scene's own settings that its export depends on: Blender reports their changes like a letter that is typed."""
    render, view, vibe = scene.render, scene.view_settings, scene.vibe
    picture = render.resolution_x, render.resolution_y, render.resolution_percentage
    subject = vibe.subject, vibe.collection and vibe.collection.name
    camera = scene.camera and scene.camera.name
    return camera, scene.frame_current, view.view_transform, view.look, *picture, *subject


class SceneSession(Driver):
    """Work on one scene, in steps between which Blender is free.

    It remembers the scene's session uid instead of the scene: after an undo a reference would be dangling.

    Attributes:
        scene: The scene's name at the start.
        warnings: What the engine sees only approximately, in words for the artist, after `view_notes`.
        view_notes: What spoils the picture whatever its look, in words for the artist.
    """

    def __init__(self, context: bpy.types.Context, engine: Engine) -> None:
        super().__init__(engine, Path(bpy.app.tempdir) / f"vibe-{uuid.uuid4().hex[:8]}")
        settings = context.scene.vibe
        self.scene, self._uid = context.scene.name, context.scene.session_uid
        self.warnings: list[str] = []
        self.view_notes: list[str] = []
        self._filling = ""  # see `SceneJob`
        self._subject: list[str] = []
        self._pivot = (0.0, 0.0, 0.0)
        self._before_path = Path()  # of the before image
        self._keyed = False  # whether keyframes are set aside for it
        self._shown: dict[str, list[float]] | None = None  # values of the look that is in the scene
        self._options = settings.engine_options(context)
        self._choice = settings.choice()

    def discard(self) -> None:
        """Deletes the temporary files, the preview's picture among them."""
        shutil.rmtree(self._job, ignore_errors=True)

    def subject(self, scene: bpy.types.Scene) -> list[bpy.types.Object]:
        """The subject's objects that are still in the scene."""
        return [scene.objects[name] for name in self._subject if name in scene.objects]

    def take_over(self, other: SceneSession) -> None:
        """Goes on with the look of another session of the same scene, if that shows one."""
        self.look, self.words = other.look, other.words
        self.preview, self.before = other.preview, other.before
        self._subject, self._pivot, self._shown = other._subject, other._pivot, other._shown
        self._keyed, other._keyed = other._keyed, False

    def show_again(self) -> None:
        """Shows the newest look again, which a file that was saved, or an undo, has left out."""
        self._shown = None
        if self.look and self._result is None and self._scene_if_there():
            self._show(self.look)

    def _show(self, look: messages.LookSoFar) -> None:
        """Shows a look in the scene, unless its values are shown already."""
        if look.values != self._shown:
            scene, self._shown = self._find_scene(), look.values
            preview.show(scene, look.values, self.subject(scene), self._pivot)

    @contextmanager
    def _without_look(self, scene: bpy.types.Scene) -> Iterator[None]:
        """The artist's scene for the duration of the block, which must not wait: then nobody sees the look go and come."""
        preview.hide(scene)
        yield
        self.show_again()

    def _object_mode(self, stage: str) -> Generator[str]:
        """Waits for Object Mode."""
        while bpy.context.mode != "OBJECT":
            self.stage = stage
            yield self.stage

    def _export(self) -> Generator[str]:
        """Reads the scene; starts again if the artist deletes something of it between two steps."""
        job = None
        while job is None:
            yield from self._object_mode("Switch to Object Mode to go on")  # meshes are empty in Edit Mode
            self.stage = READING
            scene = self._find_scene()
            with self._without_look(scene):
                self._keyed |= keyframes.are_shown(scene)
                captured = reading.prepare_and_capture(scene, self._choice)
                # The camera may move before the picture comes.
                self._before_path = preview.before_path(scene)
            visible_scene = yield from self._in_background(captured.visible_scene)
            scene = self._find_scene()
            with self._without_look(scene):
                job = reading.export_captured(scene, self._job, self._choice, visible_scene)
        self._options = replace(self._options, like=reference.picture_path(self._find_scene(), self._job))
        self._subject = [obj.name_full for obj in job.analysis.objects]
        self._pivot = job.analysis.pivot
        self.warnings, self.view_notes, self._filling = job.warnings, job.view_notes, job.filling

    def _take_look_away(self) -> None:
        self._shown = None
        if scene := self._scene_if_there():
            preview.hide(scene)
            if self._keyed:
                keyframes.bring_back(scene)
        self._keyed = False

    def _restore(self, start: int | None) -> None:
        """Takes back what the export has added, unless an undo or another file has done so already. No look may be shown."""
        if scene := self._scene_if_there():
            snapshot.rollback(scene, start)

    def _find_scene(self) -> bpy.types.Scene:
        scene = self._scene_if_there()
        if scene is None:
            raise schema.VibeError(f'The scene "{self.scene}" is gone.', "Start again in another scene.")
        return scene

    def _scene_if_there(self) -> bpy.types.Scene | None:
        """The session uid outlives renaming and undo; scenes of other files have other ones."""
        return next((s for s in bpy.data.scenes if s.session_uid == self._uid), None)
