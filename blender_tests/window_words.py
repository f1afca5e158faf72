# SPDX-License-Identifier: GPL-3.0-or-later
"""A word of the prompt is clicked, and its menu says what it may describe. See window_driver.py."""

import bpy


def words(screen):
    """A word's menu is opened with the mouse, and its last line is chosen with the keyboard."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    settings = bpy.context.scene.vibe
    settings.prompt = "glossy red monkey"
    addon_state.engine(bpy.context).start()
    screen.sidebar.tag_redraw()
    yield from screen.wait(lambda: addon_state.readings.newest.prompt == settings.prompt, 300, "words are read")
    yield 1.0
    screen.shoot("marks")
    yield from screen.click_on("vibe.reading", 143, (0.12, 0.3, 0.5))
    yield 1.0
    screen.shoot("menu")
    screen.press("End")
    yield 0.3
    screen.press("Return")
    yield from screen.wait(lambda: len(settings.targets), 60, "the choice is kept")
    screen.observed["told"] = settings.target_pairs()
    yield from screen.wait(lambda: not addon_state.readings.due(bpy.context.scene), 60, "words are read again")
    screen.observed["states"] = {word.text: word.state for word in addon_state.readings.newest.words}
    yield 1.0
    screen.shoot("told")
    for obj in bpy.context.scene.objects:  # the menu offers what is selected, too
        obj.select_set(obj.type == "MESH")
    yield from screen.click_on("vibe.reading", 143, (0.12, 0.3, 0.5))
    yield 1.0
    screen.shoot("menu_again")
    screen.press("Escape")
    settings.prompt = ""
    yield 0.3
    bpy.ops.vibe.recall(prompt="glossy red monkey")
    screen.observed["recalled"] = settings.target_pairs()
    settings.targets.clear()
    settings.prompt = "glosy monkey, flubbery light"
    screen.sidebar.tag_redraw()
    yield from screen.away()
    yield from screen.wait(lambda: addon_state.readings.newest.prompt == settings.prompt, 60, "unknown words are read")
    yield 1.0
    screen.shoot("unknown")
    screen.observed["unknown"] = {word.text: word.state for word in addon_state.readings.newest.words}
