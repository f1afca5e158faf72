# SPDX-License-Identifier: GPL-3.0-or-later
"""An artist's way with further sentences: one is typed and searched for, steps are shown and switched off. See window_driver.py."""

import bpy
from window_scene import effort, same, values
from window_steps import RIGHT, a_result, say


def further(screen):
    """A result; a sentence is typed; the first step is shown again, the second switched off; each is one undo step."""
    from bl_ext.user_default.vibe_render.run.state import addon_state
    from bl_ext.user_default.vibe_render.scene.steps import Steps

    yield from a_result(screen)
    first = values()
    screen.shoot("first")
    effort(1, 4)
    yield from say(screen, "much darker", 750)
    darker = values()
    screen.shoot("darker")
    screen.observed["failure"] = str(addon_state.failure or "")
    screen.observed["further_changes"] = darker["exposure"] != first["exposure"]
    screen.observed["sentences"] = [step.sentence for step in Steps.of(bpy.context.scene).steps]
    yield from screen.click_on("vibe.step(number=1", 852, (0.3,))
    yield from screen.wait(lambda: Steps.of(bpy.context.scene).shown == 1, 30, "the first step is shown")
    screen.observed["show_restores"] = same(values(), first, darker)
    yield from screen.undo()
    yield from screen.wait(lambda: Steps.of(bpy.context.scene).shown == 2, 30, "undo")
    yield 1.0
    screen.observed["undo_restores"] = same(values(), darker, first)
    yield from screen.click_on("number=2, act='SWITCH'", 869, RIGHT)
    yield from screen.wait(lambda: not Steps.of(bpy.context.scene).steps[1].on, 30, "a step is switched off")
    screen.observed["off_restores"] = same(values(), first, darker)
    yield from screen.away()
    screen.shoot("off")
