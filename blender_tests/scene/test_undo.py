# SPDX-License-Identifier: GPL-3.0-or-later
"""Each action on a look is one step to undo, and one to redo."""

import bpy
import pytest
from dump import difference
from test_library import NOIR, addon, own  # noqa: F401  (fixtures)
from test_operators import contents
from vibe_render.looks import library
from vibe_render.scene import snapshot


@pytest.fixture
def looks(addon, own):  # noqa: F811
    """A studio with a preset of the artist's applied: (path of it, path of another)."""
    first = str(library.save(NOIR).path)
    other = str(library.find("Cosy").path)
    bpy.ops.ed.undo_push(message="Studio")
    bpy.ops.vibe.preset_apply("EXEC_DEFAULT", True, path=first)
    return first, other


ACTIONS = {
    "keep": lambda first, other: bpy.ops.vibe.keep("EXEC_DEFAULT", True),
    "revert": lambda first, other: bpy.ops.vibe.revert("EXEC_DEFAULT", True),
    "apply": lambda first, other: bpy.ops.vibe.preset_apply("EXEC_DEFAULT", True, path=other),
}


def state():
    """What an artist sees: the scene, what changed, and whether there is a way back."""
    scene = bpy.context.scene
    counted = (".is_runtime_data", ".users")  # Blender's own counting, which any undo turns
    seen = {k: v for k, v in contents().items() if not k.endswith(counted)}
    seen["changes"] = [(c.name, tuple(c.before), tuple(c.after)) for c in scene.vibe.changes]
    return seen | {"vibed": (snapshot.exists(scene), scene.vibe.vibed_preset)}


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
