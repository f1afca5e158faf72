# SPDX-License-Identifier: GPL-3.0-or-later
"""Each action on a look is one step to undo, and one to redo."""

import bpy
import pytest
from dump import difference
from results import state
from sample_presets import NOIR
from vibe_render.looks import library


@pytest.fixture
def looks(addon, own):
    """A studio with a preset of the artist's applied: (path of it, path of another)."""
    first = str(library.save_preset(NOIR).path)
    other = str(library.find_preset("Cosy").path)
    bpy.ops.ed.undo_push(message="Studio")
    bpy.ops.vibe.preset_apply("EXEC_DEFAULT", True, path=first)
    return first, other


ACTIONS = {
    "keep": lambda first, other: bpy.ops.vibe.keep("EXEC_DEFAULT", True),
    "revert": lambda first, other: bpy.ops.vibe.revert("EXEC_DEFAULT", True),
    "apply": lambda first, other: bpy.ops.vibe.preset_apply("EXEC_DEFAULT", True, path=other),
}


@pytest.mark.parametrize("act", ACTIONS)
def test_one_step(looks, act):
    before = state()
    assert ACTIONS[act](*looks) == {"FINISHED"}
    after = state()
    assert difference(before, after)
    assert bpy.ops.ed.undo() == {"FINISHED"}
    assert difference(before, state()) == {}
    assert bpy.ops.ed.redo() == {"FINISHED"}
    assert difference(after, state()) == {}
