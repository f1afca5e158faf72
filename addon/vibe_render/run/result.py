# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe's result in the scene: written, blended with the original, kept or reverted."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import bpy

from ..core.schema_import import labels, messages, schema
from ..scene import bindings, own_backdrop, snapshot
from . import before_image, changes


def apply(
    scene: bpy.types.Scene,
    prompt: str,
    engine_result: messages.Result,
    subject: Sequence[bpy.types.Object],
    pivot: Sequence[float],
    fresh_list: bool = False,
) -> None:
    """Writes a result into the scene and lists what it changed; a failure leaves the scene as it was.

    After an earlier vibe that was not kept, the list still shows the artist's own values as the old ones, to which
    Revert goes back.

    Args:
        prompt: The words that the result is for.
        pivot: The subject's center at export.
        fresh_list: Whether the list shows the present values as the old ones instead.

    Raises:
        VibeError: The result does not fit the scene.
    """
    settings = scene.vibe
    earlier = {} if fresh_list else {c.name: (c.values()[0], c.reason) for c in settings.changes}
    current = bindings.read(scene, subject, pivot)
    skipped = bindings.write(scene, engine_result.values, subject, pivot)
    records = dict(engine_result.report.get("parameters", {}))
    values: dict[str, Sequence[float]] = {k: v for k, v in engine_result.values.items() if k not in skipped}
    for key, (own, reason) in earlier.items():
        present = current.get(key, own)  # what the earlier vibe wrote stays
        if key not in values and not labels.same(key, own, present):
            values[key], records[key] = present, {"reason": reason}
    forget(scene)
    settings.vibed_prompt, settings.pivot = prompt, pivot
    goals = engine_result.report.get("goals")
    settings.vibed_goals = json.dumps(goals, ensure_ascii=False) if goals else ""
    before = {**current, **{key: own for key, (own, _) in earlier.items()}}
    _list_changes(settings, before, _in_order(values, current), {}, records)


def _in_order(
    values: Mapping[str, Sequence[float]], scene: Mapping[str, schema.Values]
) -> dict[str, Sequence[float]]:
    """The values in the scene's order, thing by thing; lights that were added come after the others."""
    place = {key: number for number, key in enumerate(scene)}

    def order(key: str) -> tuple[int, int]:
        return schema.GROUPS.index(schema.split_key(key)[0]), place.get(key, len(place))

    return {key: values[key] for key in sorted(values, key=order)}


def _list_changes(
    settings: Any,
    before: Mapping[str, schema.Values],
    values: Mapping[str, Sequence[float]],
    skipped: Mapping[str, str],
    records: Mapping[str, Mapping[str, Any]],
) -> None:
    """Lists what has been written; a light that was not there before was dark, a backdrop the world's."""
    for key, new in values.items():
        if key not in skipped:
            dark = schema.split_key(key)[2] in ("power", "strength")
            earlier = before.get(key) or before.get(own_backdrop.OF_WORLD.get(key, ""))
            old = earlier or ((0.0,) if dark else tuple(new))
            _list_change(settings, key, old, tuple(new), records.get(key, {}))


def _list_change(
    settings: Any, key: str, before: schema.Values, after: schema.Values, record: Mapping[str, Any]
) -> None:
    change = settings.changes.add()
    change.name = key
    change.before[: len(before)] = before
    change.after[: len(after)] = after
    change.reason = record.get("reason", "")


def choose(
    scene: bpy.types.Scene,
    number: int,
    variants: Sequence[messages.Variant],
    subject: Sequence[bpy.types.Object],
) -> None:
    """Writes another variant of the last vibe in place of the one that is in the scene.

    Args:
        number: Index of the variant to write.
        variants: All of them: values that none of them has stay as an earlier vibe left them.

    Raises:
        VibeError: The values do not fit the scene.
    """
    settings, theirs = scene.vibe, {key for variant in variants for key in variant.values}
    old = {change.name: change.values()[0] for change in settings.changes}
    earlier = {c.name: (c.values()[1], c.reason) for c in settings.changes if c.name not in theirs}
    current = bindings.read(scene, subject, settings.pivot)
    values = {**{key: new for key, (new, _) in earlier.items()}, **variants[number].values}
    back = {key: was for key, was in old.items() if key not in values}
    skipped = bindings.write(scene, {**back, **values}, subject, settings.pivot)
    settings.changes.clear()
    settings.strength, settings.show_original, settings.variant = 1.0, False, number
    reasons = {**{key: reason for key, (_, reason) in earlier.items()}, **variants[number].reasons}
    records = {key: {"reason": reason} for key, reason in reasons.items()}
    _list_changes(settings, {**current, **old}, _in_order(values, current), skipped, records)


def mix(scene: bpy.types.Scene) -> None:
    """Writes the values between the original (strength 0, or Before) and the vibe (strength 1)."""
    settings = scene.vibe
    strength = 0.0 if settings.show_original else settings.strength
    values = {}
    for change in settings.changes:
        before, after = change.values()
        values[change.name] = changes.blend(change.name, before, after, strength)
    bindings.write(scene, values, (), settings.pivot)


def forget(scene: bpy.types.Scene) -> None:
    """Empties the list of changes; the scene's values stay."""
    settings = scene.vibe
    settings.changes.clear()  # first: without changes, resetting the sliders writes nothing
    settings.strength, settings.show_original = 1.0, False
    settings.vibed_prompt = settings.vibed_goals = settings.vibed_like = settings.vibed_preset = ""
    settings.variant = 0


def keep(scene: bpy.types.Scene) -> None:
    """Makes the values the artist's own; there is nothing to revert to afterwards."""
    settings = scene.vibe
    if settings.show_original:
        settings.show_original = False
    snapshot.forget(scene)
    before_image.forget(scene)
    forget(scene)


def revert(scene: bpy.types.Scene) -> list[str]:
    """Restores the scene as it was before the first vibe.

    Returns:
        What could not be restored, one line for each value.

    Raises:
        VibeError: The scene has no snapshot, or a damaged one, or one of a newer version.
    """
    lost = snapshot.revert(scene)
    before_image.forget(scene)
    forget(scene)
    return lost
