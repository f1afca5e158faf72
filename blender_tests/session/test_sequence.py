# SPDX-License-Identifier: GPL-3.0-or-later
"""Check Sequence in the panel, with the real engine: what is lost at other frames, and nothing that changes in the scene."""

import time

import bpy
import pytest
from dump import contents, difference
from vibe_render.run.state import addon_state


@pytest.fixture
def vibed(addon):
    """A result at frame 1 of seven; from frame 5 on, a flash of the artist's own hides the color."""
    settings = addon.vibe
    settings.prompt, settings.rounds, settings.steps = "red cube", 1, 2
    addon.frame_start, addon.frame_end = 1, 7
    addon.render.resolution_x, addon.render.resolution_y = 96, 64
    for frame, energy in ((4, 0.0), (5, 1e6)):
        bpy.data.lights["Area"].energy = energy
        bpy.data.lights["Area"].keyframe_insert("energy", frame=frame)
    addon.frame_set(1)
    assert bpy.ops.vibe.run() == {"FINISHED"}
    settings.check_every = 3
    return addon


def test_frames_are_checked_and_the_scene_stays(vibed):
    before, session = contents(), addon_state.session
    assert bpy.ops.vibe.check_sequence() == {"FINISHED"}
    assert addon_state.session is session
    assert not addon_state.running
    assert not session.checking
    assert [each.frame for each in session.sequence] == [1, 4, 7]
    assert [each.lost for each in session.sequence] == [[], [], ["red"]]
    assert all(each.picture.is_file() for each in session.sequence)
    assert vibed.frame_current == 1
    assert difference(before, contents()) == {}


def test_cancel_leaves_the_result_and_the_engine(vibed):
    before, session = contents(), addon_state.session
    session.check(vibed, 1)
    addon_state.running = True
    while not session.sequence:
        assert session.advance()
        time.sleep(0.02)
    assert not session.can_stop
    assert not bpy.ops.vibe.keep.poll()
    assert bpy.ops.vibe.cancel() == {"FINISHED"}
    assert addon_state.session is session
    assert session.sequence == ()
    assert vibed.frame_current == 1
    assert difference(before, contents()) == {}
    assert bpy.ops.vibe.check_sequence() == {"FINISHED"}
    assert [each.frame for each in session.sequence] == [1, 4, 7]


def test_it_needs_a_result_of_this_session(addon):
    assert not bpy.ops.vibe.check_sequence.poll()
