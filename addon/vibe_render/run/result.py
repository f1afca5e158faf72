# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe's result in the scene: written, listed, blended with the original, kept or reverted."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any

import bpy

from ..core.schema_import import labels, messages, schema
from ..scene import bindings, snapshot
from ..scene.nodes import backgrounds
from . import before_image


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
    reasons = {key: record.get("reason", "") for key, record in records.items()}
    _list_changes(settings, before, current, values, reasons)


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
    written = {key: value for key, value in values.items() if key not in skipped}
    _list_changes(settings, {**current, **old}, current, written, reasons)


def _list_changes(
    settings: Any,
    before: Mapping[str, schema.Values],
    scene: Mapping[str, schema.Values],
    values: Mapping[str, Sequence[float]],
    reasons: Mapping[str, str],
) -> None:
    """Lists what has been written, in the order of the scene; lights that were added come after the others.

    Args:
        before: The old values. A light that was not there was dark, a backdrop the world's.
        scene: Its values, in its order.
    """
    place = {key: number for number, key in enumerate(scene)}

    def order(key: str) -> tuple[int, int]:
        return schema.GROUPS.index(schema.split_key(key)[0]), place.get(key, len(place))

    for key in sorted(values, key=order):
        new = tuple(values[key])
        dark = schema.split_key(key)[2] in ("power", "strength")
        old = (
            before.get(key)
            or before.get(backgrounds.WORLD_OF_BACKDROP.get(key, ""))
            or ((0.0,) if dark else new)
        )
        change = settings.changes.add()
        change.name, change.reason = key, reasons.get(key, "")
        change.before[: len(old)] = old
        change.after[: len(new)] = new


def mix(scene: bpy.types.Scene) -> None:
    """Writes the values between the original (strength 0, or Before) and the vibe (strength 1)."""
    settings = scene.vibe
    strength = 0.0 if settings.show_original else settings.strength
    values = {}
    for change in settings.changes:
        before, after = change.values()
        values[change.name] = blend(change.name, before, after, strength)
    bindings.write(scene, values, (), settings.pivot)


def blend(key: str, before: schema.Values, after: schema.Values, strength: float) -> schema.Values:
    """A value between two others, in steps that look even: along the parameter's perceptual scale.

    Args:
        strength: 0 to 1; at both ends the result is exact.
    """
    scale = labels.parameter(key).scale
    return tuple(_between(scale, a, b, strength) for a, b in zip(before, after, strict=True))


def _between(scale: schema.Scale, a: float, b: float, t: float) -> float:
    if t in (0.0, 1.0):
        return b if t else a
    if scale.name == "log" and a > 0 and b > 0:
        return a * math.pow(b / a, t)
    if scale.name == "power" and a >= 0 and b >= 0:
        root = 1.0 / scale.exponent
        return ((1 - t) * a**root + t * b**root) ** scale.exponent
    return (1 - t) * a + t * b


def arrow(key: str, before: schema.Values, after: schema.Values) -> str:
    """The old and the new value, the unit once: "400 → 160 W"."""
    return f"{labels.bare(key, before)} → {labels.text(key, after)}"


def cause(reason: str) -> str:
    """A reason in short, the word that it quotes: "'night' (dark night scene)" is “night”."""
    quoted = re.match(r"'(.+?)'(?!\w)", reason)
    return f"“{quoted[1]}”" if quoted else reason


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
