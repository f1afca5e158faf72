# SPDX-License-Identifier: GPL-3.0-or-later
"""An artist's way with a picture instead of words: a file, an image of the .blend, a render. See window_driver.py."""

import bpy
import numpy as np
from window_scene import effort, values

HEADER = 162
"""Of the picture's panel, pixels below the window's top."""


def still(screen):
    """The picture's panel is opened; a file's path is typed, and its look searched for; then other pictures are given."""
    from bl_ext.user_default.vibe_render.render import reference
    from bl_ext.user_default.vibe_render.run.notes import words_of
    from bl_ext.user_default.vibe_render.run.state import addon_state
    from bl_ext.user_default.vibe_render.scene import snapshot

    settings, before = bpy.context.scene.vibe, values()
    path = dusk(screen.out / "dusk.png")
    yield from screen.open(HEADER, 0.3)
    yield from choose(screen, "FILE")
    yield from screen.click_at(HEADER + 58, 0.4)
    screen.press("ctrl+a")
    screen.type(str(path))
    screen.press("Return")
    yield from screen.wait(lambda: settings.like == str(path), 30, "the path arrives")
    yield from screen.away()
    yield 1.5
    screen.shoot("file")
    effort(1, 6)
    bpy.ops.ed.undo_push(message="Picture")
    yield from screen.click_on("vibe.run", 345)
    yield from screen.wait(lambda: addon_state.running, 60, "Vibe It starts")
    yield from screen.wait(lambda: not addon_state.running, 900, "the vibe ends")
    yield from screen.away()
    screen.shoot("like_a_file")
    screen.observed["like_failure"] = addon_state.failure
    screen.observed["like_changes"] = values() != before and settings.vibed_like.endswith("dusk.png")
    screen.observed["like_words"] = sorted(words_of(addon_state.session.report["verdicts"], "visible"))
    yield from screen.undo()
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "undo")
    yield from choose(screen, "IMAGE")
    settings = bpy.context.scene.vibe  # undo has made another of it
    settings.like_image = bpy.data.images.load(str(path))
    yield 1.5
    yield from screen.away()
    screen.shoot("image")
    screen.observed["like_image"] = reference.picture_name(settings)
    yield from choose(screen, "SLOT")
    yield 0.5
    yield from screen.away()
    screen.shoot("slot")
    screen.observed["like_slot"] = reference.picture_name(settings)


def dusk(path):
    """A picture of a dusk: orange below, blue above."""
    rows = np.linspace(0.0, 1.0, 90)[:, None, None]
    colors = (1 - rows) * (0.95, 0.45, 0.15) + rows * (0.1, 0.2, 0.55)
    pixels = np.concatenate([np.broadcast_to(colors, (90, 160, 3)), np.ones((90, 160, 1))], -1)
    image = bpy.data.images.new("Dusk", 160, 90)
    image.pixels.foreach_set(pixels.astype(np.float32).ravel())
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    bpy.data.images.remove(image)
    return path


def choose(screen, place):
    """Clicks one of the places that a picture may come from."""
    settings = bpy.context.scene.vibe
    yield from screen.click_on("vibe.like_from", HEADER + 31, ({"FILE": 0.3, "IMAGE": 0.55, "SLOT": 0.85}[place],))
    yield from screen.wait(lambda: settings.like_from == place, 30, place)
