# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments: looks at single frames of one scene, and the keyframes that lead from each to the next in even steps."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from bpy.types import Scene, bpy_struct
from mathutils import Vector

from ..core import compat, rendered
from ..core.color import from_oklab, to_oklab
from ..core.journal import resolve
from ..core.schema_import import labels, schema
from ..core.value_slots import PropertySlot
from . import bindings, keyframes, snapshot, steps
from .keyframes import Track
from .nodes import owned

ByKey = dict[str, list[float]]  # key of a parameter -> its components
VERSION = 1
_TOLERANCE = 0.005, 2e-4  # shares of a value and of its range: a key that is their sum or less off a line is left out
_BRIGHT = ("power", "strength", "backdrop_strength", "emission")
_TURNING = ("azimuth", "rotation")


@dataclass
class Moment:
    """A look (values found for a prompt) that the scene has at one frame."""

    frame: int
    prompt: str
    values: ByKey  # the values that the look changes
    base: ByKey  # the scene's values without the look; has all keys of `values`, and more
    pivot: list[float]  # the subject's center, world space
    subject: list[str] = field(default_factory=list)  # names of the subject's objects


def of(scene: Scene) -> list[Moment]:
    """The moments of a scene, in the order of their frames. Raises VibeError if they cannot be read."""
    try:
        raw = json.loads(scene.get(keyframes.MOMENTS, '{"moments": []}'))
        found = [Moment(**row) for row in raw["moments"]]
        for moment in found:
            if not moment.values.keys() <= moment.base.keys():
                raise ValueError("no base")
            steps.check_values(moment.values)
            steps.check_values(moment.base)
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise schema.VibeError("The moments in this file are damaged.", "Revert, and start again.") from error
    return found


def show(scene: Scene, moments: Sequence[Moment]) -> list[str]:
    """Writes the looks of all moments as keyframes, in place of earlier ones; returns sentences on values that stay.

    An object that one look adds is in the scene at all frames; an added light has no power in the other looks. Values
    with the artist's own keyframes or drivers stay.
    """
    moments = sorted(moments, key=lambda moment: moment.frame)
    keyframes.take_away(scene)
    base, looks = completed(moments)
    left: dict[str, str] = {}
    with snapshot.rollback_on_failure(scene):
        for moment, look in zip(moments, looks, strict=True):
            subject = [scene.objects[name] for name in moment.subject if name in scene.objects]
            left |= bindings.write(scene, look, subject, moment.pivot)
        notes = keyframes.add(scene, _tracks(scene, moments, base, looks) + _cards(scene, moments, looks))
    rows = [asdict(moment) for moment in moments]
    scene[keyframes.MOMENTS] = json.dumps({"version": VERSION, "moments": rows}, ensure_ascii=False)
    scene.frame_set(scene.frame_current)
    return [*(f"{labels.title(key)} stays: {reason}" for key, reason in left.items()), *notes]


def completed(moments: Sequence[Moment]) -> tuple[ByKey, list[ByKey]]:
    """(values without looks, values of each look): each by key, with all keys that any of the looks changes.

    `moments` are sorted by frame. A look has the scene's value for a key that it does not change.
    """
    base: ByKey = {}
    looks: list[ByKey] = [{} for _ in moments]
    for key in dict.fromkeys(key for moment in moments for key in moment.values):
        having = [moment for moment in moments if key in moment.values]
        last: list[float] | None = None
        for moment, look in zip(moments, looks, strict=True):
            near = min(having, key=lambda other: abs(other.frame - moment.frame))
            known = moment.base | moment.values
            if schema.light_links.link_of(key):  # no curve can link a light: it is linked at all frames
                known = near.values | known
            # An unchanged value is the scene's. A light that a look lacks is off, otherwise as in the nearest look.
            value = next((known[origin] for origin in steps.origins(key) if origin in known), near.base[key])
            if last and schema.split_key(key)[2] in _TURNING:  # an equivalent angle, at most half a turn from the last
                value = [last[0] + (value[0] - last[0] + 180.0) % 360.0 - 180.0]
            look[key] = last = value
        base[key] = having[0].base[key]
    return base, looks


def between(key: str, first: Sequence[float], last: Sequence[float], share: float) -> list[float]:
    """The value at a share, 0 to 1, of the way from `first` to `last`, in steps that look even; exact at both ends."""
    if share in (0.0, 1.0) or list(first) == list(last):
        return list(last if share else first)
    parameter = labels.parameter(key)
    if parameter.unit == "K":  # in mireds
        return [1.0 / _straight(1.0 / first[0], 1.0 / last[0], share)]
    if parameter.kind == "color":
        found = from_oklab(_straight(to_oklab(np.array(first)), to_oklab(np.array(last)), share))
        return [min(float(v), max(1.0, *first, *last)) for v in found]  # OKLab may leave the gamut
    if parameter.name in _BRIGHT:
        # In stops, but from or to 0 almost linearly, so that a cross-fade of two lights keeps the brightness.
        dim = 0.0 if min(first[0], last[0]) > 0.0 else max(first[0], last[0])
        return [math.exp(_straight(math.log(first[0] + dim), math.log(last[0] + dim), share)) - dim]
    if parameter.name in _TURNING:
        return [_straight(first[0], last[0], share)]  # without a wrap at 360
    return steps.along(key, first, (first, last), share)


def _straight(first: Any, last: Any, share: float) -> Any:
    return first + share * (last - first)


def _tracks(scene: Scene, moments: Sequence[Moment], base: ByKey, looks: Sequence[ByKey]) -> list[Track]:
    """Keyframes for every property that the looks change; `base` and `looks` are the result of `completed`."""
    samples = _samples(moments, looks)
    pivot = Vector(moments[-1].pivot)
    # Each sampled look is written through the bindings, and the properties that this changes are read back. So lights
    # move on arcs. (data-block, path, name) of a property -> its values by frame; None is the scene without looks.
    found: dict[tuple[int, str, str], dict[int | None, Any]] = {}
    seen: list[int | None] = []
    with snapshot.undone(scene) as journal:
        for frame, look, place in ((None, base, moments[-1].pivot), *samples):
            way, pivot = Vector(place) - pivot, Vector(place)
            # The lights that Vibe Render added orbit the subject's center: they move with it.
            for light in (o for o in scene.objects if o.type == "LIGHT" and owned.MARK in o) if way.length else ():
                journal.set(light, "location", light.location + way)
            rendered.layer(scene).update()
            bindings.put(journal, scene, look, (), pivot)
            rendered.layer(scene).update()
            for entry in journal.entries:
                slot = entry["id"], entry.get("path", ""), entry.get("name", "")
                old = entry.get("old")  # the property's value before this entry
                numeric = entry["op"] == "set" and isinstance(old, bool | int | float | list)
                if numeric and slot not in found:
                    found[slot] = dict.fromkeys(seen, tuple(old) if isinstance(old, list) else old)
            for (number, path, name), values in found.items():
                values[frame] = PropertySlot(resolve(journal.ids[number], path), name).get()
            seen.append(frame)
        frames = [moment.frame for moment in moments]
        tracks = []
        for (number, path, name), values in found.items():
            tracks += _curves(resolve(journal.ids[number], path), name, values, frames)
        return tracks


def _samples(moments: Sequence[Moment], looks: Sequence[ByKey]) -> list[tuple[int, ByKey, list[float]]]:
    """(frame, values by key, pivot) at each moment and at up to 15 frames between two moments, in order."""
    found = [(moments[0].frame, looks[0], moments[0].pivot)]
    for (one, first), (other, last) in pairwise(zip(moments, looks, strict=True)):
        count = min(other.frame - one.frame, 16)  # straight lines between 16 samples are within 1 % of the even steps
        for number in range(1, count + 1):
            frame = one.frame + round(number * (other.frame - one.frame) / count)
            share = (frame - one.frame) / (other.frame - one.frame)
            look = {key: between(key, first[key], last[key], share) for key in first}
            pivot = [_straight(a, b, share) for a, b in zip(one.pivot, other.pivot, strict=True)]
            found.append((frame, look, pivot))
    return found


def _cards(scene: Scene, moments: Sequence[Moment], looks: Sequence[ByKey]) -> list[Track]:
    """Keyframes for the opacity of each card, which shapes one light's shadow: 0 at moments when that light is off."""
    tracks = []
    for card in (o for o in scene.objects if o.get(owned.MARK) == owned.CARD and o.parent):
        keys = [f"light/{card.parent.name}/{name}" for name in ("power", "strength")]
        lit = [any(look.get(key, [0.0])[0] for key in keys) for look in looks]
        with snapshot.transaction(scene) as journal:
            if not card.data.materials:
                material = owned.new(journal, "materials", owned.CARD)
                tree = compat.enable_nodes(material)
                tree.nodes.clear()
                kinds = ("BsdfTransparent", "BsdfDiffuse", "MixShader", "OutputMaterial")
                clear, gray, mix, output = (tree.nodes.new(f"ShaderNode{kind}") for kind in kinds)
                mix.name = owned.CARD
                tree.links.new(clear.outputs[0], mix.inputs[1])
                tree.links.new(gray.outputs[0], mix.inputs[2])
                tree.links.new(mix.outputs[0], output.inputs["Surface"])
                journal.append_material(card.data, material)
        opacity = card.data.materials[0].node_tree.nodes[owned.CARD].inputs[0]
        values = {moment.frame: float(shines) for moment, shines in zip(moments, lit, strict=True)}
        tracks.append(Track(opacity, "default_value", 0, values))
    return tracks


def _curves(owner: bpy_struct, name: str, values: dict[int | None, Any], frames: Sequence[int]) -> list[Track]:
    """Keyframes for each component of a property that changes: at the moments, and as few between them as possible.

    `values`: frame -> value; frame None has the value without looks and is removed. `frames`: those of the moments.
    """
    base = values.pop(None)
    by_frame = {frame: value for frame, value in values.items() if frame is not None}
    every = list(by_frame)
    if not owner.bl_rna.properties[name].is_animatable:
        return []
    if isinstance(base, bool):
        if all(flag == base for flag in by_frame.values()):
            return []
        # Between two samples a flag is set only if both have it: what is hidden at one of them is visible on the way.
        flags = {a: by_frame[a] and by_frame[b] for a, b in pairwise([*every, every[-1]])}
        changes = [b for a, b in pairwise(every) if flags[a] != flags[b]]
        return [Track(owner, name, 0, {frame: flags[frame] for frame in (every[0], *changes)})]
    rows = np.array([np.atleast_1d(value) for value in (base, *by_frame.values())], float)
    if name == "rotation_quaternion":  # the negative is the same rotation
        for before, now in pairwise(rows):
            now *= math.copysign(1.0, before @ now)
    tracks = []
    for index, column in enumerate(rows.T):
        if np.ptp(column) > 1e-6 * max(np.abs(column).max(), 1.0):  # smaller changes are rounding of 32-bit numbers
            # Keys at the moments, and where straight lines between them would miss a value.
            kept = {every.index(frame) for frame in frames}
            for one, other in pairwise(sorted(kept)):
                _keep(np.array(every, float), column[1:], one, other, kept)
            tracks.append(Track(owner, name, index, {every[i]: float(column[1 + i]) for i in sorted(kept)}))
    return tracks


def _keep(frames: np.ndarray, values: np.ndarray, one: int, other: int, kept: set[int]) -> None:
    """Adds to `kept` the index between `one` and `other` that a straight line misses most, then treats both halves.

    Nothing is added if the line misses no value by more than `_TOLERANCE`.
    """
    if other - one < 2:
        return
    inside = slice(one, other + 1)
    line = np.interp(frames[inside], frames[[one, other]], values[[one, other]])
    allowed = _TOLERANCE[0] * np.abs(values[inside]) + _TOLERANCE[1] * np.ptp(values) + 1e-9
    missed = np.abs(line - values[inside]) / allowed
    worst = one + int(missed.argmax())
    if missed.max() > 1.0:
        kept.add(worst)
        _keep(frames, values, one, worst, kept)
        _keep(frames, values, worst, other, kept)
