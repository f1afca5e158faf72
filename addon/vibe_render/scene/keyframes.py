# SPDX-License-Identifier: GPL-3.0-or-later
"""The keyframes that Vibe Render adds. A journal records them apart from the snapshot, to mute and remove them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bpy.types import ID, FCurve, Scene, bpy_struct

from ..core import compat, stored_journal
from ..core.journal import Journal, JournalEntry, address

KEY = "vibe_keyframes"
MOMENTS = "vibe_moments"  # property with the looks that the keyframes were made from, see `moments`


@dataclass(frozen=True)
class Track:
    """Keyframes of one property, or of component `index` of an array property: frame -> number or boolean."""

    owner: bpy_struct
    name: str
    index: int
    values: Mapping[int, float]


def add(scene: Scene, tracks: Sequence[Track]) -> list[str]:
    """Adds a curve for each track's property, which has none yet; returns why data-blocks cannot have any."""
    journal, left = Journal(), {}
    try:
        for track in tracks:
            block, _ = address(track.owner)
            if reason := obstacle(track.owner.id_data):
                left[block.name] = f'"{block.name}" keeps one value at all frames: {reason}.'
                continue
            # Recorded before the curve: undo runs backward, so it restores the stored value after removing the curve.
            journal.set(track.owner, track.name, getattr(track.owner, track.name))
            curve = journal.curve(track.owner, track.name, track.index)
            curve.keyframe_points.add(len(track.values))
            for point, (frame, value) in zip(curve.keyframe_points, track.values.items(), strict=True):
                point.co = frame, value
                point.interpolation = "CONSTANT" if isinstance(value, bool) else "LINEAR"
            curve.update()
    except BaseException:
        journal.undo()
        raise
    stored_journal.store(scene, KEY, journal)
    return list(left.values())


def obstacle(block: ID) -> str:
    """The reason why keyframes cannot be added to a data-block; "" if they can be added."""
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


def exist(scene: Scene) -> bool:
    """True if the scene has keyframes that Vibe Render added, muted or not."""
    return KEY in scene


def are_shown(scene: Scene) -> bool:
    """True if the scene has keyframes that Vibe Render added and that are not muted."""
    return any(not curve.mute for *_, curve in _curves(scene))


def _curves(scene: Scene) -> list[tuple[JournalEntry, ID, FCurve]]:
    return stored_journal.sound(scene, KEY).curves("curve")


def set_aside(scene: Scene) -> bool:
    """Mutes Vibe Render's keyframes and keeps their values at the current frame; returns True if any was unmuted."""
    shown = are_shown(scene)
    for _, block, curve in _curves(scene):
        # Blender 5 does not write the values of a compositor's curves into its nodes.
        compat.set_to_curve(block, curve, scene.frame_current)
        curve.mute = True
    return shown


def bring_back(scene: Scene) -> None:
    """Unmutes Vibe Render's keyframes."""
    for *_, curve in _curves(scene):
        curve.mute = False


def take_away(scene: Scene) -> list[str]:
    """Removes Vibe Render's keyframes, restores the earlier values; returns, in words, what could not be restored."""
    journal = stored_journal.sound(scene, KEY)
    scene.pop(KEY, None)  # first: the property counts as a user of the blocks to remove
    return journal.undo()


def forget(scene: Scene) -> None:
    """Makes Vibe Render's keyframes the artist's own: removes only the records about them."""
    for key in (KEY, MOMENTS):
        scene.pop(key, None)
