# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside a Blender with a window: an artist's way through the panel, with mouse and keyboard.

    blender --python window_driver.py -- ZIP OUT

Writes a screenshot of every step and OUT/steps.json: what was seen, or what went wrong.
"""

import faulthandler
import json
import subprocess
import sys
import time
import traceback
from itertools import product
from pathlib import Path
from typing import Any

import bpy

ZIP, OUT = map(Path, sys.argv[sys.argv.index("--") + 1 :][:2])
PROMPT = "misty night, cool blue fog, glossy red monkey, vignette"
seen: dict[str, Any] = {}


class Screen:
    """The mouse, the keyboard and the eye of somebody who sits in front of the window."""

    def __init__(self) -> None:
        self.window = bpy.context.window_manager.windows[0]
        self.area = next(a for a in self.window.screen.areas if a.type == "VIEW_3D")
        self._number = 0

    @property
    def sidebar(self):
        """The region of the sidebar."""
        return next(r for r in self.area.regions if r.type == "UI")

    @property
    def view(self):
        """The region of the viewport itself."""
        return next(r for r in self.area.regions if r.type == "WINDOW")

    def inside(self):
        """Context of the sidebar."""
        return bpy.context.temp_override(window=self.window, area=self.area, region=self.sidebar)

    def shoot(self, name):
        """Takes a screenshot."""
        self._number += 1
        (OUT / "steps.json").write_text(json.dumps(seen, indent=1))
        subprocess.run(["import", "-window", "root", OUT / f"{self._number:02}_{name}.png"], check=True)

    def move(self, x, y):
        """Moves the mouse; Blender's coordinates, from the lower left."""
        subprocess.run(["xdotool", "mousemove", str(int(x)), str(int(self.window.height - y))], check=True)

    def press(self, *keys):
        """Presses keys, one after the other."""
        subprocess.run(["xdotool", "key", *keys], check=True)

    def type(self, text):
        """Types."""
        subprocess.run(["xdotool", "type", "--delay", "5", text], check=True)

    def click(self):
        """Clicks where the mouse is."""
        subprocess.run(["xdotool", "click", "1"], check=True)

    def under_mouse(self):
        """The property or operator of the button that the mouse is over, as Blender says it."""
        with self.inside():
            if bpy.context.property:
                return bpy.context.property[1]
            bpy.context.window_manager.clipboard = ""
            if bpy.ops.ui.copy_python_command_button.poll():
                bpy.ops.ui.copy_python_command_button()
            return bpy.context.window_manager.clipboard

    def find(self, what):
        """Sweeps the sidebar with the mouse until it is over a button; a generator of waits."""
        region = self.sidebar
        rows = range(region.y + region.height - 30, region.y, -14)
        met = set()
        for patience in (0.03, 0.3):  # the second time as slowly as a busy machine needs
            for y, x in product(rows, (0.3, 0.75, 0.82, 0.93)):
                self.move(region.x + region.width * x, y)
                yield patience
                if what in (there := self.under_mouse()):
                    return
                met.add(there)
        raise LookupError(f"There is no {what} in the sidebar, but {sorted(met)}.")

    def undo(self):
        """Presses Ctrl+Z over the viewport."""
        self.move(self.view.x + 200, self.view.y + 200)
        yield 0.2
        self.press("ctrl+z")

    def click_on(self, what):
        """Finds a button and clicks it."""
        yield from self.find(what)
        self.click()
        yield 0.3


def a_scene():
    """A monkey on a floor, lit by two lamps."""
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    bpy.ops.mesh.primitive_plane_add(size=12)
    bpy.ops.mesh.primitive_monkey_add(size=2, location=(0, 0, 1.0))
    monkey = bpy.context.object
    monkey.modifiers.new("Subdivision", "SUBSURF").levels = 1
    bpy.ops.object.shade_smooth()
    for name, color in (("Floor", (0.35, 0.33, 0.3, 1)), ("Monkey", (0.75, 0.6, 0.45, 1))):
        material = bpy.data.materials.new(name)
        material.use_nodes = True
        material.diffuse_color = color
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = color
        bpy.data.objects["Plane" if name == "Floor" else "Suzanne"].data.materials.append(material)
    for name, place, power in (("Key", (3, -3, 4), 400), ("Rim", (-3, 3, 3), 200)):
        bpy.ops.object.light_add(type="AREA", location=place)
        bpy.context.object.name, bpy.context.object.data.energy = name, power
        bpy.context.object.rotation_euler = bpy.context.object.location.to_track_quat("Z", "Y").to_euler()
    bpy.ops.object.camera_add(location=(0, -6.5, 2.2), rotation=(1.4, 0, 0))
    bpy.context.scene.camera = bpy.context.object


def values():
    """What a vibe may change, as far as a scene like this one has it."""
    scene = bpy.context.scene
    dump = {
        f"{light.name}.{p}": repr(getattr(light, p)) for light in bpy.data.lights for p in ("energy", "color")
    }
    for material in (bpy.data.materials["Floor"], bpy.data.materials["Monkey"]):
        inputs = material.node_tree.nodes["Principled BSDF"].inputs
        dump |= {f"{material.name}.{i.name}": _plain(i) for i in inputs if hasattr(i, "default_value")}
    dump |= {f"{o.name}.matrix": str(o.matrix_world) for o in bpy.data.objects if o.type != "MESH"}
    return dump | {"objects": str(len(bpy.data.objects)), "exposure": repr(scene.view_settings.exposure)}


def _plain(socket):
    value = socket.default_value
    return repr(list(value)) if hasattr(value, "__len__") and not isinstance(value, str) else repr(value)


def wait(condition, seconds, what):
    """Waits, as a generator of waits; notes the longest time, by what goes on, that Blender did not come back.

    It is this thread's time on a core: what the artist waits for, without what other programs take.
    """
    from bl_ext.user_default.vibe_render.session import desk

    end = time.monotonic() + seconds
    while not condition():
        last = time.monotonic()
        if last > end:
            raise TimeoutError(f"{what} within {seconds} s")
        stage = desk.session.stage if desk.running and desk.session else "idle"
        busy = time.thread_time()
        yield 0.1
        pauses = seen.setdefault("pauses", {})
        pauses[stage] = round(max(pauses.get(stage, 0.0), time.thread_time() - busy), 3)


def the_way():
    """Every step; yields how long to wait before the next one, in seconds."""
    yield 0.5
    screen = Screen()
    with bpy.context.temp_override(window=screen.window, area=screen.area, region=screen.view):
        bpy.ops.extensions.package_install_files(
            filepath=str(ZIP), repo="user_default", enable_on_install=True
        )
        a_scene()
        bpy.ops.ed.undo_push(message="Scene")
    from bl_ext.user_default.vibe_render import snapshot
    from bl_ext.user_default.vibe_render.engine_place import place
    from bl_ext.user_default.vibe_render.session import desk

    seen["schema_is_the_copy"] = not any(name.startswith("proxy_renderer") for name in sys.modules)
    yield from preferences(screen, place)
    space = screen.area.spaces.active
    space.shading.color_type, space.region_3d.view_perspective = "MATERIAL", "CAMERA"
    space.show_region_ui = True
    yield 0.5
    screen.sidebar.active_panel_category = "Vibe"
    screen.sidebar.tag_redraw()
    small(100, 1000)
    yield 0.5
    screen.shoot("panel")
    before = values()

    yield from screen.click_on("vibe.prompt")
    screen.press("ctrl+a")
    screen.type(PROMPT)
    screen.press("Return")
    yield from wait(lambda: bpy.context.scene.vibe.prompt, 60, "the prompt arrives")
    yield 0.5
    seen["prompt"] = bpy.context.scene.vibe.prompt
    screen.shoot("prompt")

    # Esc while it looks takes the best so far; one undo takes that back.
    yield from screen.click_on("vibe.run")
    yield from wait(lambda: desk.running, 60, "Vibe It starts")
    yield from wait(lambda: desk.session.progress, 900, "progress is seen")
    yield 1.5
    screen.shoot("progress")
    seen["progress"] = desk.session.fraction
    screen.press("Escape")
    yield from wait(lambda: not desk.running, 600, "Esc ends it")
    yield 0.5
    seen["esc_takes_the_best"] = snapshot.exists(bpy.context.scene) and not desk.failure
    screen.shoot("stopped")
    yield from screen.undo()
    yield from wait(lambda: not snapshot.exists(bpy.context.scene), 30, "undo of what Esc took")
    yield 0.7
    seen["esc_undo_restores"] = values() == before

    # Esc twice gives it up.
    yield from screen.click_on("vibe.run")
    yield from wait(lambda: desk.running, 60, "Vibe It starts again")
    yield from wait(lambda: desk.session and desk.session.progress, 900, "progress is seen again")
    yield 0.5
    screen.press("Escape", "Escape")
    yield from wait(lambda: not desk.running, 60, "Esc twice ends it")
    yield 0.3
    screen.shoot("canceled")
    seen["cancel_restores"] = values() == before and not snapshot.exists(bpy.context.scene)

    small(1, 4)
    bpy.context.scene.vibe.variants = 3
    bpy.ops.ed.undo_push(message="Fewer steps")
    yield from screen.click_on("vibe.run")
    yield from wait(lambda: desk.running, 60, "Vibe It starts once more")
    yield from wait(lambda: not desk.running, 900, "the vibe ends")
    yield 0.7
    screen.shoot("result")
    seen["failure"] = str(desk.failure or "")
    after = values()
    seen["changed"] = [key for key in after if after[key] != before.get(key)]
    seen["listed"] = [change.name for change in bpy.context.scene.vibe.changes]

    yield from screen.undo()
    yield from wait(lambda: not snapshot.exists(bpy.context.scene), 60, "undo")
    yield 0.7
    screen.shoot("undone")
    seen["undo_restores"] = values() == before and not snapshot.exists(bpy.context.scene)
    screen.press("ctrl+shift+z")
    yield from wait(lambda: snapshot.exists(bpy.context.scene), 60, "redo")
    yield 0.7
    seen["redo_restores"] = values() == after
    yield from with_the_result(screen, before, after)

    yield from screen.click_on("vibe.revert")
    yield from wait(lambda: not snapshot.exists(bpy.context.scene), 60, "revert")
    yield 0.5
    screen.shoot("reverted")
    seen["revert_restores"] = values() == before and not snapshot.exists(bpy.context.scene)


def preferences(screen, place):
    """What the add-on's preferences look like, and whether they find and try the engine."""
    kind, screen.area.type = screen.area.type, "PREFERENCES"
    bpy.context.preferences.active_section = "ADDONS"
    bpy.context.window_manager.addon_search = "Vibe"
    with bpy.context.temp_override(window=screen.window, area=screen.area):
        bpy.ops.preferences.addon_expand(module="bl_ext.user_default.vibe_render")
    yield from wait(lambda: place.python, 60, "the engine is found")
    place.test("")
    yield from wait(lambda: place.said, 600, "the engine answers")
    yield 0.5
    seen["engine"] = place.said
    screen.shoot("preferences")
    screen.area.type = kind
    yield 0.5


def with_the_result(screen, before, after):
    """Before and after, as rendered, and the panel in the properties editor."""
    scene = bpy.context.scene
    yield from screen.click_on("show_original")
    yield from wait(lambda: scene.vibe.show_original, 60, "Before is pressed")
    seen["compare_shows_before"] = same(values(), before, after)
    screen.shoot("compare")
    scene.vibe.show_original = False
    shading = screen.area.spaces.active.shading
    shading.type = "RENDERED"
    yield 6.0
    screen.shoot("rendered")
    shading.type = "SOLID"
    editor = next(a for a in screen.window.screen.areas if a.type == "PROPERTIES")
    editor.spaces.active.context = "RENDER"
    yield 1.0
    screen.shoot("properties")


def small(rounds, steps):
    """A vibe that is over soon."""
    settings = bpy.context.scene.vibe
    settings.budget, settings.rounds, settings.steps, settings.size = "CUSTOM", rounds, steps, 192


def same(now, before, after):
    """Whether all that a vibe changed is as before; nodes of its own may be there."""
    return all(now[key] == before[key] for key in before if key != "objects" and key in after)


def main():
    """Walks the way on Blender's timer, so that Blender works in between."""
    faulthandler.enable()  # where Python was if Blender crashes
    bpy.context.preferences.view.show_splash = False
    steps = the_way()

    def tick():
        try:
            return next(steps)
        except StopIteration:
            seen["finished"] = True
        except Exception:
            seen["error"] = traceback.format_exc()
            subprocess.run(["import", "-window", "root", OUT / "99_error.png"], check=False)
        (OUT / "steps.json").write_text(json.dumps(seen, indent=1))
        bpy.ops.wm.quit_blender()
        return None

    bpy.app.timers.register(tick, first_interval=1.0)


if __name__ == "__main__":
    main()
