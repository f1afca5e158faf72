# SPDX-License-Identifier: Apache-2.0
"""The fields of `report.json` that the engine knows."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from importlib import metadata
from typing import TYPE_CHECKING, Any

import torch

from .. import __version__
from ..claims.claim import ShotClaims
from ..goals.written import as_json
from ..optimize.rounds.method import VARIABLE
from ..schema import Values

if TYPE_CHECKING:
    from ..optimize.anchoring import BlenderPictures
    from ..optimize.pipeline import Outcome
    from ..optimize.shots import ShotState
    from ..words.types import PromptWord

_PACKAGES = ("torch", "open_clip_torch", "numpy", "opencolorio", "trimesh")


def search_facts(outcome: Outcome, words: Sequence[PromptWord]) -> dict[str, Any]:
    """Parameters, rounds, and how the prompt is understood."""
    goals, prompts = outcome.goals, outcome.prompts
    return {
        "method": os.environ.get(VARIABLE, ""),
        "goals": as_json(goals),
        "parameters": parameter_records(outcome),
        "rounds": outcome.rounds,
        "understood": {
            "subject": prompts.subject,
            "surroundings": prompts.surroundings,
            "whole": prompts.whole,
            "classes": goals.classes,
            "ignored": goals.parsed.ignored,
            "guesses": goals.parsed.guesses,
            "words": [word.row() for word in words],
            "notes": list(dict.fromkeys([*goals.parsed.notes, *outcome.plan.notes])),
        },
        "versions": versions(),
    }


def parameter_records(outcome: Outcome) -> dict[str, dict[str, Any]]:
    """Records of all parameters of the scene.

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


def plain(values: Values) -> float | list[float]:
    """A number for one component, a list for several."""
    return values[0] if len(values) == 1 else list(values)


def changed_values(outcome: Outcome, shot: ShotState | None = None) -> dict[str, list[float]]:
    """Key -> components that differ from the artist's scene, under the names of one of several shots, or of the first."""
    vector = (shot or outcome).vector
    return {k: list(v) for k, v in vector.changes(outcome.u).items()}


def anchored(outcome: Outcome, blenders: Sequence[BlenderPictures]) -> dict[str, Any]:
    """{"anchored": {"pictures", "predicted", "notes"}} on the pictures of Cycles that corrected the proxy of each shot.

    `predicted` is the mean CIEDE2000 between what was predicted and what the next picture of Cycles showed, the
    last time; of several shots, their mean.
    """
    pictures, predicted, notes = [], [], []
    for shot, blender in zip(outcome.shots, blenders, strict=True):
        pairs = zip(shot.records, blender.seconds, strict=True)
        records = [{**record, "seconds": seconds} for record, seconds in pairs]
        pictures += records
        predicted += [records[-1]["delta_e"]] if records else []
        notes += blender.notes
    mean = {"predicted": round(sum(predicted) / len(predicted), 3)} if predicted else {}
    return {"anchored": {"pictures": pictures, **mean, "notes": list(dict.fromkeys(notes))}}


def claims_about(outcome: Outcome) -> list[ShotClaims]:
    """The claims about each shot."""
    found = []
    for shot in outcome.shots:
        assert shot.before is not None, "the loop has begun"
        found.append(ShotClaims(outcome.claims, shot.before.seen, shot.gbuffer(outcome.u)))
    return found


def foreseen(outcome: Outcome, claims: list[ShotClaims]) -> list[dict[str, Any]]:
    """Verdicts on the first shot's prediction, as the last anchors have it."""
    shot = outcome.shots[0]
    assert shot.before is not None, "the loop has begun"
    with torch.no_grad():
        after = shot.draw(outcome.u).display
    return claims[0].verdicts(shot.before.display, after, after)


def versions() -> dict[str, str]:
    """Versions of the engine and of the packages that it runs on."""
    installed = {"vibe-render": __version__, "python": platform.python_version()}
    for package in _PACKAGES:
        try:
            installed[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return installed
