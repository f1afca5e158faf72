# SPDX-License-Identifier: GPL-3.0-or-later
"""A preview: values that are in the scene for as long as a vibe runs, and can be taken away without a trace.

A preview is not part of the snapshot: before the result is written, the scene has the artist's values again. A value
that the artist changes while a preview is shown stays changed.

This module also stores before images, to compare with: they show the artist's scene before its first vibe, and stay in
Blender's temporary folder until Keep or Revert. There is one for each resolution, camera pose and frame, because only
images with the same framing can be compared.
"""

import contextlib
import shutil
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import bpy
from bpy.types import Object, Scene

from ..core import rendered, stored_journal
from ..core.files import whole
from ..core.journal import Journal
from ..core.schema_import import schema
from ..scene import bindings

KEY = "vibe_preview"  # custom property of a scene: the journal that takes its preview away


def show(
    scene: Scene, values: Mapping[str, Sequence[float]], subject: Sequence[Object], pivot: Sequence[float]
) -> None:
    """Shows values, by key, in place of an earlier preview; raises as `bindings.write`, and then shows no preview."""
    _take_away(scene)
    journal = Journal()
    try:
        bindings.put(journal, scene, values, subject, pivot)
    except BaseException:
        journal.undo()
        raise
    finally:
        rendered.layer(scene).update()
    shown = Journal()
    shown.extend(journal)  # keeps only the first record of each value
    shown.remember()
    stored_journal.store(scene, KEY, shown)


def exists(scene: Scene) -> bool:
    """True if the scene shows a preview."""
    return KEY in scene


def hide(scene: Scene) -> None:
    """Takes the preview away, if there is one; the scene has the artist's values again."""
    if exists(scene):
        _take_away(scene)
        rendered.layer(scene).update()


def hide_all() -> None:
    """Takes the previews out of all scenes, also those that an undo or a loaded file has brought back."""
    for scene in bpy.data.scenes:
        if scene.is_editable:
            hide(scene)


def _take_away(scene: Scene) -> None:
    if not exists(scene):
        return
    journal = stored_journal.sound(scene, KEY)
    del scene[KEY]  # first: the property counts as a user of data-blocks that `undo` removes
    journal.undo()


def before_path(scene: Scene) -> Path:
    """The path of the before image for the scene's present camera, frame and resolution, whether it exists or not."""
    camera, size = scene.camera, (scene.render.resolution_x, scene.render.resolution_y)
    pose = [round(x, 4) for row in camera.matrix_world for x in row] if camera else []
    lens = round(camera.data.angle, 4) if camera else 0.0
    framing = zlib.crc32(repr((size, scene.frame_current, pose, lens)).encode())
    return Path(bpy.app.tempdir) / f"vibe-before-{scene.session_uid}-{framing:08x}.png"


def store_before(path: Path, picture: Path, first: bool) -> Path:
    """Copies `picture` to `path` as the before image, if `first`; returns the path of the image to compare with.

    `first` is True if the scene had no earlier vibe. The image to compare with is at `path`, or else it is `picture`.
    """
    if first:
        # On a full disk nothing is stored; a later vibe then compares with its own start.
        with contextlib.suppress(schema.VibeError), whole(path) as part:
            shutil.copyfile(picture, part)
    return path if path.is_file() else picture


def forget_before(scene: Scene) -> None:
    """Deletes the before images of a scene, after Keep or Revert."""
    for path in Path(bpy.app.tempdir).glob(f"vibe-before-{scene.session_uid}-*"):
        path.unlink(missing_ok=True)
