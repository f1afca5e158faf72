# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene on its way to the engine and back; what the panel and the command line share."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import bpy
from mathutils import Vector as Vector3

from ..core.schema_import import schema
from ..scene import fog, scene_context, snapshot
from ..scene.prepare import prepare
from ..scene.subject import Choice, named
from .analysis import Capture, Prospect, Survey, blocks, capture, like, refuse, survey
from .job import Job, known
from .job import export as write_job

Read = TypeVar("Read")


def open_job(
    scene: bpy.types.Scene,
    folder: Path,
    choice: Choice,
    around: Survey | None = None,
    eyes: Sequence[Vector3] = (),
) -> Job:
    """Adds what the scene lacks and writes its job folder; a failure leaves the scene as it was.

    Args:
        scene: The scene.
        folder: Made if it does not exist.
        choice: How the subject is chosen.
        around: Of an earlier shot of this scene: the same things are the subject, and lights turn around where it was.
        eyes: Where the cameras of all its shots stand: the same fog holds them all.

    Raises:
        VibeError: The scene cannot be worked with; see `survey.survey`.
    """

    def write(found: Survey) -> Job:
        if eyes:
            fog.plan(scene, fog.domain(scene_context.Cast(scene, found.objects, Vector3(found.pivot)), eyes))
        return write_job(like(found, around) if around else found, folder)

    return _opened(scene, choice, write)


def begin(scene: bpy.types.Scene, choice: Choice) -> Capture:
    """Half of `open_job`, for a Blender that stays free in between. Taking back what failed is the caller's."""
    refuse(scene)
    ready(scene, choice)
    return capture(scene)


def finish(scene: bpy.types.Scene, folder: Path, choice: Choice, prospect: Prospect) -> Job | None:
    """The other half; None if what was read is not all there any more, so that one has to begin again."""
    if scene.camera is None or not snapshot.exists(scene) or not prospect.blocks <= blocks():
        return None
    return write_job(survey(scene, choice, prospect), folder)


def ready(scene: bpy.types.Scene, choice: Choice) -> None:
    """Adds what the scene lacks, as it was when the scene was exported."""
    prepare(scene, named(scene, choice))
    snapshot.take(scene)


@dataclass(frozen=True)
class Sight:
    """What presets need to know of a scene: less than a job, and nothing is written to disk.

    Attributes:
        survey: The scene as it was looked at.
        instances: Its parameters, by key.
    """

    survey: Survey
    instances: dict[str, schema.Instance]


def look_at(scene: bpy.types.Scene, choice: Choice) -> Sight:
    """Looks at a scene; nothing in it is changed. Raises as `open_job` does."""
    refuse(scene)
    found = survey(scene, choice)
    return Sight(found, known(found))


def open_sight(scene: bpy.types.Scene, choice: Choice) -> Sight:
    """Adds what the scene lacks and looks at it; a failure leaves the scene as it was. Raises as `open_job` does."""
    return _opened(scene, choice, lambda found: Sight(found, known(found)))


@contextmanager
def untouched_on_failure(scene: bpy.types.Scene) -> Iterator[None]:
    """Takes back what was recorded meanwhile if it ends in an exception."""
    was_vibed, start = snapshot.exists(scene), snapshot.mark(scene)
    try:
        yield
    except BaseException:
        if snapshot.exists(scene):
            snapshot.rollback(scene, start)
            if was_vibed:
                snapshot.take(scene)
        raise


def _opened(scene: bpy.types.Scene, choice: Choice, read: Callable[[Survey], Read]) -> Read:
    refuse(scene)
    with untouched_on_failure(scene):
        ready(scene, choice)
        return read(survey(scene, choice))
