# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe's result in the scene: written, listed, blended with the original, kept or reverted."""

import json
import re
from collections.abc import Sequence

import bpy

from ..core.schema_import import messages, schema
from ..scene import bindings, keyframes, moments, own_keys, snapshot
from ..scene import steps as step_list
from ..scene.moments import Moment
from ..scene.steps import Change, Steps
from . import preview


def apply(
    scene: bpy.types.Scene,
    prompt: str,
    engine_result: messages.Result,
    subject: Sequence[bpy.types.Object],
    pivot: Sequence[float],
    change: Change | None = None,
) -> None:
    """Writes a result into the scene and lists the changed values; a failure leaves the scene as it was.

    After an earlier vibe that was not kept, the old values in the list are still the artist's own, to which Revert goes
    back. `change` is the effect of a further sentence on the steps; None for a first prompt. `subject` and `pivot` are
    as for `bindings.instances`.
    """
    settings = scene.vibe
    current = bindings.read(scene, subject, pivot)
    skipped = bindings.write(scene, engine_result.values, subject, pivot)
    written = {key: value for key, value in engine_result.values.items() if key not in skipped}
    goals = engine_result.report.get("goals") or {}
    reasons = {key: row.get("reason", "") for key, row in engine_result.report.get("parameters", {}).items()}
    change = change or Change(Steps(), title=prompt, first=True)
    steps = change.steps
    steps.pivot = list(pivot)
    steps.add(change, current, written, reasons, goals)
    show(scene, steps)
    if change.first:
        settings.vibed_prompt, settings.pivot, settings.variant = prompt, pivot, 0
        settings.vibed_goals = json.dumps(goals, ensure_ascii=False) if goals else ""
        settings.vibed_like = settings.vibed_preset = ""


def show(scene: bpy.types.Scene, steps: Steps) -> None:
    """Writes the values of the shown steps, lists the changed values, and stores the steps; a failure changes nothing.

    Materials or lights that the artist has deleted stay deleted. Raises VibeError if the values do not fit the scene.
    """
    settings = scene.vibe
    current = bindings.read(scene, (), steps.pivot)
    current = dict.fromkeys(filter(schema.light_links.link_of, steps.values()), (0.0,)) | current
    values = {key: tuple(value) for key, value in steps.values().items() if key in current}
    differing = {k: v for k, v in values.items() if not step_list.same(k, v, current[k])}
    skipped = bindings.write(scene, differing, (), steps.pivot)
    before = {**current, **steps.base, **{change.name: change.values()[0] for change in settings.changes}}
    # Values that an earlier vibe wrote, and no step has, stay in the list.
    reasons = {change.name: change.reason for change in settings.changes if change.name not in values}
    values = {key: current[key] for key in reasons if key in current} | values
    for step in steps.steps[: steps.shown]:
        reasons |= step.reasons if step.on else {}
    listed = {k: v for k, v in values.items() if k not in skipped and not step_list.same(k, v, before[k])}
    settings.changes.clear()  # first: without changes, resetting the sliders writes nothing
    settings.strength, settings.show_original = 1.0, False
    # The list is by group, in the order of the scene's keys; other keys come last in their group.
    place = {key: number for number, key in enumerate(current)}
    for key in sorted(listed, key=lambda k: (schema.GROUPS.index(schema.split_key(k)[0]), place.get(k, len(place)))):
        new = tuple(listed[key])
        old = step_list.old_value(key, before, new)
        change = settings.changes.add()
        change.name, change.reason = key, reasons.get(key, "")
        change.before[: len(old)] = old
        change.after[: len(new)] = new
    steps.store(scene)


def choose(scene: bpy.types.Scene, number: int, variant: messages.Variant, subject: Sequence[bpy.types.Object]) -> None:
    """Writes `variant`, with its number among the last vibe's variants (from 0), in place of the one in the scene."""
    settings, steps = scene.vibe, Steps.of(scene)
    current = bindings.read(scene, subject, steps.pivot)
    change = Change(steps, title=settings.vibed_prompt, place=0 if steps.steps else None)
    goals = json.loads(settings.vibed_goals or "{}")
    skipped = bindings.write(scene, variant.values, subject, steps.pivot)
    written = {key: value for key, value in variant.values.items() if key not in skipped}
    steps.add(change, {**current, **steps.base}, written, variant.reasons, goals)
    show(scene, steps)
    settings.variant = number


def mix(scene: bpy.types.Scene) -> None:
    """Writes the listed values, blended between the original (strength 0, or Before) and the vibe (strength 1)."""
    settings = scene.vibe
    strength = 0.0 if settings.show_original else settings.strength
    values = {}
    for change in settings.changes:
        before, after = change.values()
        values[change.name] = step_list.along(change.name, before, (before, after), strength)
    bindings.write(scene, values, (), settings.pivot)


def cause(reason: str) -> str:
    """The word that a reason quotes, or else the whole reason: “night” for "'night' (dark night scene)"."""
    quoted = re.match(r"'(.+?)'(?!\w)", reason)
    return f"“{quoted[1]}”" if quoted else reason


def keyframe(scene: bpy.types.Scene) -> list[str]:
    """Keyframes the listed values at the current frame; returns a line on each value that was left alone.

    Keyframes of looks at other frames stay; those of an earlier look at this frame are replaced.
    """
    settings = scene.vibe
    if settings.show_original:
        settings.show_original = False
    pivot = list(settings.pivot)
    found = [moment for moment in moments.of(scene) if moment.frame != scene.frame_current]
    keyframes.set_aside(scene)  # sets all values to those that the keyframes have at this frame
    current = bindings.read(scene, (), pivot)
    changes = {change.name: change.values()[0] for change in settings.changes if change.name in current}
    values = {key: list(current[key]) for key in changes}
    base = {key: list(before) for key, before in changes.items()}
    for moment in found:  # what the artist has deleted does not come back
        moment.values = {key: value for key, value in moment.values.items() if key in current}
    return moments.show(scene, [*found, Moment(scene.frame_current, settings.vibed_prompt, values, base, pivot)])


def keep(scene: bpy.types.Scene) -> None:
    """Makes the result's values the artist's own; there is nothing to revert to afterwards."""
    settings = scene.vibe
    if settings.show_original:
        settings.show_original = False
    own_keys.release(scene)
    snapshot.forget(scene)
    _forget(scene)


def revert(scene: bpy.types.Scene) -> list[str]:
    """Restores the scene as it was before the first vibe; returns a line on each value that could not be restored.

    Raises as `snapshot.load`.
    """
    lost = snapshot.revert(scene)
    _forget(scene)
    return lost


def _forget(scene: bpy.types.Scene) -> None:
    """Deletes the before images and empties the list of changes; the scene's values stay."""
    preview.forget_before(scene)
    settings = scene.vibe
    settings.changes.clear()  # first: without changes, resetting the sliders writes nothing
    settings.strength, settings.show_original = 1.0, False
    settings.vibed_prompt = settings.vibed_goals = settings.vibed_like = settings.vibed_preset = ""
    settings.variant = 0
