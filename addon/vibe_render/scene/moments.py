# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments: looks at frames of one scene, and the keyframes that lead from each to the next in steps that look even."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np
from bpy.types import Object, Scene
from mathutils import Vector

from ..core import rendered
from ..core.color import from_oklab, to_oklab
from ..core.journal import Journal, resolve
from ..core.schema_import import labels, schema
from ..core.value_slots import PropertySlot, same
from . import bindings, keyframes, snapshot, steps
from .keyframes import Track
from .nodes import owned

Look = dict[str, list[float]]
VERSION = 1
_PIECES = 16  # of the way between two moments: straight lines between them are within 1 % of the even steps
_TOLERANCE = 0.005, 2e-4  # of a value, and of its range: a key that is missed by less is left out
_BRIGHT = ("power", "strength", "backdrop_strength", "emission")
_TURNING = ("azimuth", "rotation")
_DIM = 1 / 64  # of a light that goes on: below, its steps are those of watts instead of stops


@dataclass
class Moment:
    """A look at a frame.

    Attributes:
        values: By key, of what the look changes.
        base: By key, of the same scene without the look; more keys do no harm.
        pivot: The subject's center, world space.
        subject: Names of its objects.
    """

    frame: int
    prompt: str
    values: Look
    base: Look
    pivot: list[float]
    subject: list[str] = field(default_factory=list)


def of(scene: Scene) -> list[Moment]:
    """The moments of a scene, in the order of their frames. Raises VibeError if they cannot be read."""
    try:
        raw = json.loads(scene.get(keyframes.MOMENTS, '{"moments": []}'))
        found = [Moment(**row) for row in raw["moments"]]
        for look in (look for moment in found for look in (moment.values, moment.base)):
            for key, value in look.items():
                if len(value) != labels.parameter(key).components or not all(map(math.isfinite, value)):
                    raise ValueError(key)
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise schema.VibeError("The moments in this file are damaged.", "Revert, and start again.") from error
    return found


def show(scene: Scene, moments: Sequence[Moment]) -> list[str]:
    """Writes looks at their frames, as keyframes, in place of those of ours that are there.

    What only one of them has is in the scene at all frames, a light without power. Values with the artist's own keyframes
    or drivers stay.

    Returns:
        What has been left alone, and why, in words for the artist.
    """
    moments = sorted(moments, key=lambda moment: moment.frame)
    keyframes.take_away(scene)
    base, looks = completed(moments)
    start = snapshot.mark(scene)
    left: dict[str, str] = {}
    try:
        for moment, look in zip(moments, looks, strict=True):
            left |= bindings.write(scene, look, _objects(scene, moment), moment.pivot)
        tracks = _tracks(scene, moments, base, looks)
        notes = keyframes.add(scene, tracks)
    except BaseException:
        if snapshot.exists(scene):
            snapshot.rollback(scene, start)
        raise
    rows = [asdict(moment) for moment in moments]
    scene[keyframes.MOMENTS] = json.dumps({"version": VERSION, "moments": rows}, ensure_ascii=False)
    scene.frame_set(scene.frame_current)
    return [*(f"{labels.title(key)} stays: {reason}" for key, reason in left.items()), *notes]


def completed(moments: Sequence[Moment]) -> tuple[Look, list[Look]]:
    """The scene's values without the looks, and each look with the keys of all of them.

    What a look does not change is as in the scene without it. A light that it lacks is dark, and otherwise as in the
    nearest look that has it. Azimuths go on from the one before by the short way.
    """
    base: Look = {}
    looks: list[Look] = [{} for _ in moments]
    for key in dict.fromkeys(key for moment in moments for key in moment.values):
        having = [moment for moment in moments if key in moment.values]
        last: list[float] | None = None
        for moment, look in zip(moments, looks, strict=True):
            near = min(having, key=lambda other: abs(other.frame - moment.frame))
            known = {**moment.base, **moment.values}
            value = list(moment.values.get(key) or steps.old_value(key, known, near.values[key]))
            look[key] = last = _short_way(key, last, value)
        base[key] = list(steps.old_value(key, moments[0].base, looks[0][key]))
    return base, looks


def _short_way(key: str, last: list[float] | None, value: list[float]) -> list[float]:
    if last is None or schema.split_key(key)[2] not in _TURNING:
        return value
    return [last[0] + (value[0] - last[0] + 180.0) % 360.0 - 180.0]


def between(key: str, first: Sequence[float], last: Sequence[float], share: float) -> list[float]:
    """A value on the way from one to another, in steps that look even; exact at both ends.

    Temperatures go by mireds, colors through OKLab, lights by stops, azimuths straight, and all else along its scale.
    """
    if share in (0.0, 1.0) or list(first) == list(last):
        return list(last if share else first)
    parameter = labels.parameter(key)
    if parameter.unit == "K":
        return [1.0 / _straight(1.0 / first[0], 1.0 / last[0], share)]
    if parameter.kind == "color":
        return [float(v) for v in from_oklab(_straight(to_oklab(np.array(first)), to_oklab(np.array(last)), share))]
    if parameter.name in _BRIGHT:
        return [_by_stops(first[0], last[0], share)]
    if parameter.name in _TURNING:
        return [_straight(first[0], last[0], share)]
    return steps.along(key, first, (first, last), share)


def _straight(first: Any, last: Any, share: float) -> Any:
    return first + share * (last - first)


def _by_stops(first: float, last: float, share: float) -> float:
    dim = 0.0 if min(first, last) > 0.0 else _DIM * max(first, last)
    return math.exp(_straight(math.log(first + dim), math.log(last + dim), share)) - dim


def _tracks(scene: Scene, moments: Sequence[Moment], base: Look, looks: Sequence[Look]) -> list[Track]:
    """The properties that the looks change, with their values by frame.

    All that the values mean in Blender is written, and what was written is read: so lights move on arcs, and every
    parameter is keyframed through its own binding.
    """
    samples = _samples(moments, looks)
    journal = Journal()
    found: dict[tuple[int, str, str], dict[int, Any]] = {}
    try:
        pivot = Vector(moments[-1].pivot)
        bindings.put(journal, scene, base, (), pivot)
        for frame, look, place in samples:
            _follow(journal, scene, Vector(place) - pivot)
            pivot = Vector(place)
            bindings.put(journal, scene, look, (), pivot)
            rendered.layer(scene).update()
            for entry in journal.entries:
                if entry["op"] == "set" and _is_number(entry["old"]):
                    slot = entry["id"], entry["path"], entry["name"]
                    if slot not in found:  # until now it has had its old value
                        earlier = (f for f, *_ in samples if f < frame)
                        found[slot] = dict.fromkeys(earlier, _frozen(entry["old"]))
            for (number, path, name), values in found.items():
                values[frame] = PropertySlot(resolve(journal.ids[number], path), name).get()
        tracks = [
            Track(resolve(journal.ids[number], path), name, values)
            for (number, path, name), values in found.items()
        ]
    finally:
        journal.undo()
        rendered.layer(scene).update()
    frames = [moment.frame for moment in moments]
    tracks += _cards(scene, samples)
    return [_thinned(track, frames) for track in tracks if _can_be_keyed(track)]


def _samples(moments: Sequence[Moment], looks: Sequence[Look]) -> list[tuple[int, Look, list[float]]]:
    """Frames from the first moment to the last, each with all values and the pivot there."""
    found = [(moments[0].frame, looks[0], moments[0].pivot)]
    for (one, first), (other, last) in pairwise(zip(moments, looks, strict=True)):
        count = min(other.frame - one.frame, _PIECES)
        for number in range(1, count + 1):
            frame = one.frame + round(number * (other.frame - one.frame) / count)
            share = (frame - one.frame) / (other.frame - one.frame)
            look = {key: between(key, first[key], last[key], share) for key in first}
            pivot = [_straight(a, b, share) for a, b in zip(one.pivot, other.pivot, strict=True)]
            found.append((frame, look, pivot))
    return found


def _follow(journal: Journal, scene: Scene, way: Vector) -> None:
    """Moves lights of ours with the subject: they turn around its center, and look at it."""
    for light in (o for o in scene.objects if o.type == "LIGHT" and owned.MARK in o) if way.length else ():
        journal.set(light, "location", light.location + way)
    rendered.layer(scene).update()


def _cards(scene: Scene, samples: Sequence[tuple[int, Look, Any]]) -> list[Track]:
    """Cards before lights, hidden while their light is off: their shadow would fall into the light of others."""
    cards = (o for o in scene.objects if o.get(owned.MARK) == schema.added_lights.CARD and o.parent)
    tracks = []
    for card in cards:
        keys = [f"light/{card.parent.name}/{name}" for name in ("power", "strength")]
        dark = {f: not any(look.get(key, [0.0])[0] for key in keys) for f, look, _ in samples}
        tracks.append(Track(card, "hide_render", dark))
    return tracks


def _is_number(value: Any) -> bool:
    return isinstance(value, bool | int | float | list)


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _can_be_keyed(track: Track) -> bool:
    values = list(track.values.values())
    changes = any(not same(value, values[0]) for value in values)
    constant_flag = isinstance(values[0], bool) and not changes
    return track.owner.bl_rna.properties[track.name].is_animatable and not constant_flag


def _thinned(track: Track, frames: Sequence[int]) -> Track:
    """A track with keys at the moments, and between them only where a straight line would miss the values."""
    every = list(track.values)
    if isinstance(track.values[every[0]], bool):  # what is seen next must be there on the way to it
        late = {a: track.values[a] and track.values[b] for a, b in pairwise([*every, every[-1]])}
        return Track(track.owner, track.name, late)
    values = np.array([np.atleast_1d(v) for v in track.values.values()], float)
    if track.name == "rotation_quaternion":  # the negative is the same rotation
        for before, now in pairwise(values):
            now *= math.copysign(1.0, before @ now)
    spread = np.ptp(values, axis=0)
    kept: set[int] = set()
    for one, other in pairwise(every.index(frame) for frame in frames):
        _keep(np.array(every, float), values, one, other, spread, kept)
    kept |= {every.index(frame) for frame in frames}
    is_array = isinstance(track.values[every[0]], tuple)
    keys = {every[i]: tuple(map(float, values[i])) if is_array else float(values[i][0]) for i in sorted(kept)}
    return Track(track.owner, track.name, keys)


def _keep(
    frames: np.ndarray, values: np.ndarray, one: int, other: int, spread: np.ndarray, kept: set[int]
) -> None:
    """Adds the key between two others that a straight line misses most, and goes on in both halves."""
    if other - one < 2:
        return
    share = ((frames[one : other + 1] - frames[one]) / (frames[other] - frames[one]))[:, None]
    inside = values[one : other + 1]
    line = inside[0] + share * (inside[-1] - inside[0])
    allowed = _TOLERANCE[0] * np.abs(inside) + _TOLERANCE[1] * spread + 1e-9
    missed = (np.abs(line - inside) / allowed).max(axis=1)
    worst = int(missed.argmax())
    if missed[worst] > 1.0:
        kept.add(one + worst)
        _keep(frames, values, one, one + worst, spread, kept)
        _keep(frames, values, one + worst, other, spread, kept)


def _objects(scene: Scene, moment: Moment) -> list[Object]:
    return [scene.objects[name] for name in moment.subject if name in scene.objects]
