# SPDX-License-Identifier: GPL-3.0-or-later
"""Keyframes of ours, with a journal of their own on top of a scene's snapshot: they can be set aside, brought back and removed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bpy.types import ID, FCurve, Scene, bpy_struct

from ..core import compat, stored_journal
from ..core.journal import Journal, JournalEntry, address

KEY = "vibe_keyframes"
MOMENTS = "vibe_moments"  # the looks that they were made of, see `moments`


@dataclass(frozen=True)
class Track:
    """The values of a property by frame, numbers or flags; of an array, those of one component."""

    owner: bpy_struct
    name: str
    index: int
    values: Mapping[int, float]


def add(scene: Scene, tracks: Sequence[Track]) -> list[str]:
    """Writes curves for properties that have none; returns what could not be keyframed, and why."""
    journal, left = Journal(), {}
    try:
        for track in tracks:
            block, _ = address(track.owner)
            if reason := obstacle(track.owner.id_data):
                left[block.name] = f'"{block.name}" keeps one value at all frames: {reason}.'
                continue
            # First: curves change the value that is stored, so that is to be restored after they are gone.
            journal.set(track.owner, track.name, getattr(track.owner, track.name))
            _write(journal, track)
    except BaseException:
        journal.undo()
        raise
    stored_journal.store(scene, KEY, journal)
    return list(left.values())


def obstacle(block: ID) -> str:
    """Why keyframes cannot be added to a data-block; "" where they can."""
    data = block.animation_data
    action = data.action if data else None
    if action is None:
        return ""
    if action.library:
        return f'its action "{action.name}" is linked from a library'
    if data.action_slot is None:
        return f'its action "{action.name}" has no slot'
    others = [user.name for user in data.action_slot.users() if user != block]
    return f'it shares its action with "{others[0]}"' if others else ""


def _write(journal: Journal, track: Track) -> None:
    curve = journal.curve(track.owner, track.name, track.index)
    curve.keyframe_points.add(len(track.values))
    for point, (frame, value) in zip(curve.keyframe_points, track.values.items(), strict=True):
        point.co = frame, value
        point.interpolation = "CONSTANT" if isinstance(value, bool) else "LINEAR"
    curve.update()


def exist(scene: Scene) -> bool:
    """True if the scene has keyframes of ours, also if they are set aside."""
    return KEY in scene


def are_shown(scene: Scene) -> bool:
    """True if the scene has some that are not set aside."""
    return any(not curve.mute for *_, curve in _curves(scene))


def _curves(scene: Scene) -> list[tuple[JournalEntry, ID, FCurve]]:
    return stored_journal.sound(scene, KEY).curves("curve")


def set_aside(scene: Scene) -> bool:
    """Mutes them, so that another look can be searched from what they show now; returns whether they were shown before."""
    shown = are_shown(scene)
    for _, block, curve in _curves(scene):
        # Blender 5 does not keep the values of a compositor up to date.
        compat.set_to_curve(block, curve, scene.frame_current)
        curve.mute = True
    return shown


def bring_back(scene: Scene) -> None:
    """Shows those that were set aside."""
    for *_, curve in _curves(scene):
        curve.mute = False


def take_away(scene: Scene) -> list[str]:
    """Removes them, and restores the values below; returns what could not be restored."""
    journal = stored_journal.sound(scene, KEY)
    scene.pop(KEY, None)  # first: it counts as a user of what is to be removed
    return journal.undo()


def forget(scene: Scene) -> None:
    """Keeps them as the artist's own."""
    for key in (KEY, MOMENTS):
        scene.pop(key, None)
