# SPDX-License-Identifier: Apache-2.0
"""What is left behind of a vibe: the report's fields, and the picture that compares."""

from __future__ import annotations

import platform
from collections.abc import Sequence
from importlib import metadata
from typing import TYPE_CHECKING, Any

from .. import __version__
from ..schema import Values

if TYPE_CHECKING:
    from ..optimize.anchoring import BlenderPictures
    from ..optimize.pipeline import Outcome
    from ..optimize.shots import ShotState

_PACKAGES = ("torch", "open_clip_torch", "numpy", "opencolorio", "trimesh")


def parameter_records(outcome: Outcome) -> dict[str, dict[str, Any]]:
    """What `report.json` says of every parameter of the scene.

    Returns:
        Key -> before, after, lower, upper, moved (on the perceptual scale), priority (the confiner's π, 0 comes first;
        None is irrelevant), optimized, reason.
    """
    after = outcome.vector.values(outcome.u)
    lower, upper = (outcome.vector.plain(b) for b in outcome.vector.bounds(outcome.ranges))
    return {
        key: {
            "before": plain(instance.value),
            "after": plain(after[key]),
            "lower": plain(lower[key]),
            "upper": plain(upper[key]),
            "moved": round(instance.distance(after[key]), 4),
            "priority": outcome.plan[key].priority,
            "optimized": key in outcome.optimized,
            "reason": instance.locked or outcome.plan[key].reason,
        }
        for key, instance in outcome.vector.instances.items()
    }


def changed_values(outcome: Outcome, shot: ShotState | None = None) -> dict[str, list[float]]:
    """Key -> components, of what differs from the artist's scene; in one of several shots, under its names.

    Args:
        shot: One of several; None for the shared names.
    """
    vector = (shot or outcome).vector
    return {k: list(v) for k, v in vector.changes(outcome.u).items()}


def anchored(outcome: Outcome, blenders: Sequence[BlenderPictures]) -> dict[str, Any]:
    """How the proxies were corrected, one for each shot.

    `predicted` is the mean CIEDE2000 between what was predicted and what the next picture of Cycles showed, the
    last time; of several shots, their mean.

    Args:
        blenders: The picture source of each shot.

    Returns:
        {"anchored": {"pictures", "predicted", "notes"}}.
    """
    pictures, predicted, notes = [], [], []
    for shot, blender in zip(outcome.shots, blenders, strict=True):
        pairs = zip(shot.anchoring.records, blender.seconds, strict=True)
        records = [{**record, "seconds": seconds} for record, seconds in pairs]
        pictures += records
        predicted += [records[-1]["delta_e"]] if records else []
        notes += blender.notes
    mean = {"predicted": round(sum(predicted) / len(predicted), 3)} if predicted else {}
    return {"anchored": {"pictures": pictures, **mean, "notes": list(dict.fromkeys(notes))}}


def plain(values: Values) -> float | list[float]:
    """A number for one component, a list for several."""
    return values[0] if len(values) == 1 else list(values)


def versions() -> dict[str, str]:
    """What the engine runs on."""
    installed = {"vibe-render": __version__, "python": platform.python_version()}
    for package in _PACKAGES:
        try:
            installed[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return installed
