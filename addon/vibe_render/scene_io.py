# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene on its way to the engine and back; what the panel and the command line share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import bpy

from . import snapshot
from .export import Job
from .export import export as write_job
from .prepare import prepare
from .subject import Choice, named
from .survey import refuse, survey

Vector = tuple[float, float, float]


def export(scene: bpy.types.Scene, folder: Path, choice: Choice) -> tuple[Sequence[bpy.types.Object], Vector]:
    """Adds what the scene lacks and writes its job folder; a failure leaves the scene as it was.

    Returns:
        The subject's objects and the pivot, as `bindings.write` wants them.

    Raises:
        VibeError: The scene cannot be worked with; see `survey.survey`.
    """
    job = open_job(scene, folder, choice)
    return job.survey.objects, job.survey.pivot


def open_job(scene: bpy.types.Scene, folder: Path, choice: Choice) -> Job:
    """The same, returning all that is known about the scene."""
    refuse(scene)
    was_vibed, start = snapshot.exists(scene), snapshot.mark(scene)
    try:
        prepare(scene, named(scene, choice))
        snapshot.take(scene)
        return write_job(survey(scene, choice), folder)
    except BaseException:
        if snapshot.exists(scene):
            snapshot.rollback(scene, start)
            if was_vibed:
                snapshot.take(scene)
        raise
