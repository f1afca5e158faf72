# SPDX-License-Identifier: GPL-3.0-or-later
"""An artist's hour with one scene: a vibe, further sentences, a change by hand, light mix, keyframes, a sequence. See window_driver.py."""

import bpy
from window_mix import first_slider
from window_scene import effort, same, values
from window_steps import LIGHT_MIX, PRESETS, ended, header, open_panel, say
from window_tour import bust

PROMPT = "cool moonlight from the left, dark blue background"
SENTENCES = ("make the turtleneck deep red", "no, the coat, not the turtleneck", "and a warm rim light")
FRAMES = (1, 25, 50, 75, 100)


def hour(screen):
    """All of it in a row; nothing is lost on the way, and Revert takes back everything."""
    from bl_ext.user_default.vibe_render.scene import snapshot

    with screen.over(screen.view):
        bust()
    yield 1.0
    yield from open_panel(screen)
    scene = bpy.context.scene
    scene.frame_end, scene.render.resolution_percentage, scene.cycles.samples = FRAMES[-1], 50, 32
    scene.vibe.shared = "ALL"  # a question that another way answers
    bpy.ops.ed.undo_push(message="Bust")
    before = values()
    effort(2, 8)
    yield from vibed(screen)
    for number, sentence in enumerate(SENTENCES, start=1):
        yield from said(screen, sentence, number)
    yield from by_hand(screen)
    yield from mixed(screen)
    yield from moments(screen)
    yield from checked(screen)
    yield from frames(screen)
    screen.observed["steps"] = sentences()
    yield from screen.click_on("vibe.revert", 665, (0.8, 0.7))
    yield from screen.wait(lambda: not snapshot.exists(bpy.context.scene), 60, "revert")
    yield from screen.away()
    screen.shoot("reverted")
    screen.observed["revert_restores"] = values() == before
    screen.observed["no_keyframes_stay"] = not any(block.animation_data for block in animated())


def sentences():
    """The sentences of the list of steps."""
    from bl_ext.user_default.vibe_render.scene.steps import Steps

    return [step.sentence for step in Steps.of(bpy.context.scene).steps]


def animated():
    """Data-blocks that a look can have keyframes in."""
    scene = bpy.context.scene
    trees = [t for t in (scene.world.node_tree, *(m.node_tree for m in bpy.data.materials)) if t]
    return [scene, scene.world, *bpy.data.lights, *bpy.data.materials, *trees, *bpy.data.objects]


def vibed(screen):
    """The prompt is typed and searched for."""
    yield from screen.type_into("vibe.prompt", PROMPT, 130)
    yield from screen.wait(lambda: bpy.context.scene.vibe.prompt == PROMPT, 60, "the prompt arrives")
    yield from screen.click_on("vibe.run", 295)
    yield from ended(screen, "the vibe")
    screen.shoot("vibe")


def said(screen, sentence, number):
    """A further sentence is typed and searched for."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    yield from say(screen, sentence, 730 + 20 * number)
    assert not addon_state.failure, addon_state.failure
    screen.shoot(f"sentence_{number}")
    screen.observed.setdefault("sentences", []).append(sentences())


def by_hand(screen):
    """The artist dims the fill light, and says another sentence: both count."""
    fill = bpy.data.lights["Fill Light"]
    dimmed = fill.energy = 0.5 * fill.energy
    bpy.ops.ed.undo_push(message="Dim")
    yield from said(screen, "a bit brighter", len(SENTENCES) + 1)
    screen.observed["hand_made_stays"] = abs(bpy.data.lights["Fill Light"].energy - dimmed) < 1e-3 * dimmed


def mixed(screen):
    """The lights are rendered apart, the first slider is dragged, and the mix is applied."""
    yield from header(screen, LIGHT_MIX)  # Result is there, and closes; Light Mix is below it
    yield from header(screen, PRESETS)
    x, row = yield from first_slider(screen, 440)
    yield from screen.drag((x, row), (x + 40, row), "slider_dragged")
    before = values()
    yield from screen.click_on("vibe.mix_apply", 720, (0.2,))
    yield from screen.wait(lambda: values() != before, 60, "Apply")
    yield from screen.away()
    screen.shoot("mix_applied")
    yield from header(screen, PRESETS)
    yield from header(screen, LIGHT_MIX)


def moments(screen):
    """The look is keyframed at the first frame, another one at the last."""
    from bl_ext.user_default.vibe_render.scene import moments

    yield from screen.click_on("vibe.keyframe", 630, (0.5,))
    yield from screen.wait(lambda: len(moments.of(bpy.context.scene)) == 1, 60, "the first keyframe")
    first = values()
    bpy.context.scene.frame_set(FRAMES[-1])
    yield from said(screen, "much darker", len(sentences()))
    yield from screen.click_on("vibe.keyframe", 630, (0.5,))
    yield from screen.wait(lambda: len(moments.of(bpy.context.scene)) == 2, 60, "the second keyframe")
    last = values()
    yield from screen.away()
    screen.shoot("keyframed")
    bpy.context.scene.frame_set(FRAMES[0])
    yield 0.5
    screen.observed["first_look_at_its_frame"] = same(values(), first, last)


def checked(screen):
    """Every 25th frame is measured."""
    from bl_ext.user_default.vibe_render.run.state import addon_state

    bpy.context.scene.vibe.check_every = 25
    yield from screen.click_on("vibe.check_sequence", 800, (0.2,), page=1)
    yield from ended(screen, "the check")
    screen.shoot("checked")
    screen.observed["frames_checked"] = len(addon_state.session.sequence)


def frames(screen):
    """Five final frames, as the artist's render settings have them."""
    scene = bpy.context.scene
    for frame in FRAMES:
        scene.frame_set(frame)
        scene.render.filepath = str(screen.out / f"frame_{frame:03}.png")
        bpy.ops.render.render(write_still=True)
        yield 0.5
