# SPDX-License-Identifier: GPL-3.0-or-later
"""The picture to compare with: of the scene as it was before its first vibe, as the camera saw it then."""

import time

import bpy
import pytest
from vibe_render.run.session import preview
from vibe_render.run.state import addon_state
from vibing import advance


def test_it_stays_the_one_of_before(addon, tmp_path):
    own, vibed_once = tmp_path / "own.png", tmp_path / "vibed.png"
    own.write_bytes(b"own")
    vibed_once.write_bytes(b"vibed")
    assert preview.store_before(preview.before_path(addon), own, True).read_bytes() == b"own"
    assert preview.store_before(preview.before_path(addon), vibed_once, False).read_bytes() == b"own"
    addon.frame_set(addon.frame_current + 1)
    assert preview.store_before(preview.before_path(addon), vibed_once, False) == vibed_once  # another sight
    addon.frame_set(addon.frame_current - 1)
    preview.forget_before(addon)
    assert preview.store_before(preview.before_path(addon), vibed_once, False) == vibed_once


@pytest.mark.slow
def test_a_camera_that_moves_meanwhile(addon):
    """Again, from where the camera was, finds it; from where it is now, it would show something else."""
    running = advance(lambda r: r.asked)
    there = preview.before_path(addon)
    addon.camera.location.x += 1.0
    bpy.context.view_layer.update()
    here = preview.before_path(addon)
    while running.before is None:
        assert running.advance()
        time.sleep(0.02)
    addon_state.cancel()
    assert here != there
    assert there.is_file()
    assert not here.exists()
