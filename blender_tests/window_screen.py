# SPDX-License-Identifier: GPL-3.0-or-later
"""Somebody in front of a Blender window: eye, mouse, keyboard, patience. See window_driver.py.

What takes time is a generator of waits, in seconds, so that Blender works in between.
"""

import json
import subprocess
import time
from itertools import product

import bpy

PLACES = (0.45, 0.2, 0.72, 0.86)
"""Where buttons are, across the sidebar."""

ROW = 16
"""Pixels between two looks; the least button has 20."""


class Screen:
    """The window, and what has been seen in it."""

    def __init__(self, out, observed) -> None:
        self.out, self.observed = out, observed
        self._number, self._page = 0, 0
        self.look()

    def look(self, kind="VIEW_3D"):
        """Turns to an editor, in whichever window it is; another file brings others."""
        windows = bpy.context.window_manager.windows
        self.window, self.area = next((w, a) for w in windows for a in w.screen.areas if a.type == kind)

    @property
    def scale(self):
        """How large everything is; pixels in the ways are for 1."""
        return bpy.context.preferences.system.ui_scale

    @property
    def sidebar(self):
        """The region that our panels are in: the viewport's sidebar, or the whole of other editors."""
        kind = "UI" if self.area.type == "VIEW_3D" else "WINDOW"
        return next(r for r in self.area.regions if r.type == kind)

    @property
    def view(self):
        """The region of the viewport itself."""
        return next(r for r in self.area.regions if r.type == "WINDOW")

    def over(self, region):
        """Context of a region, as if the mouse were there."""
        return bpy.context.temp_override(window=self.window, area=self.area, region=region)

    def shoot(self, name):
        """Takes a screenshot."""
        self._number += 1
        self.note()
        path = self.out / f"{self._number:02}_{name}.png"
        subprocess.run(["import", "-window", "root", path], check=True)

    def note(self):
        """Writes down what has been seen."""
        (self.out / "steps.json").write_text(json.dumps(self.observed, indent=1))

    def move(self, x, y):
        """Moves the mouse; Blender's coordinates, from the window's lower left."""
        screen = bpy.context.window_manager.windows[0].height  # the first window is all of it
        place = x + self.window.x, screen - self.window.y - y
        subprocess.run(["xdotool", "mousemove", *(str(int(p)) for p in place)], check=True)

    def press(self, *keys):
        """Presses keys, one after the other."""
        subprocess.run(["xdotool", "key", *keys], check=True)

    def type(self, text):
        """Types."""
        subprocess.run(["xdotool", "type", "--delay", "5", text], check=True)

    def click(self, button=1, times=1):
        """Clicks where the mouse is; buttons 4 and 5 are the wheel."""
        subprocess.run(["xdotool", "click", "--repeat", str(times), "--delay", "20", str(button)], check=True)

    def under_mouse(self):
        """The property or operator of the button that the mouse is over, as Blender says it."""
        with self.over(self.sidebar):
            if bpy.context.property:
                return bpy.context.property[1]
            bpy.context.window_manager.clipboard = ""
            if bpy.ops.ui.copy_python_command_button.poll():
                bpy.ops.ui.copy_python_command_button()
            return bpy.context.window_manager.clipboard

    def find(self, what, near=0, places=PLACES, page=0):
        """Moves the mouse over a button of the sidebar: looks around where it should be, then page by page.

        Args:
            what: Its property, or a part of its operator's call.
            near: Where to begin, in pixels (at a scale of 1) below the window's top; a busy machine takes a second for each look.
            places: Across the sidebar, in parts of its width.
            page: How far down the sidebar it should be; a page takes half a minute to look through.
        """
        met, row = set(), round(ROW * self.scale)
        for turned in sorted(range(4), key=lambda other: abs(other - page)):
            yield from self.turn_to(turned)
            region = self.sidebar
            rows = [*range(region.y + 8, region.y + region.height - 24, row)]
            start = self.window.height - near * self.scale if near else rows[-1]
            looks = product(places, sorted(rows, key=lambda y: abs(y - start)))
            for x, y in sorted(looks, key=lambda look: abs(look[1] - start) > 4 * row):  # around it first
                self.move(region.x + region.width * x, y)
                yield 0.05
                yield 0.05  # Blender has been round once more, and knows where the mouse is
                there = self.under_mouse()
                if what in there:
                    self.observed.setdefault("found", {})[what] = [x, self.window.height - y, turned]
                    return
                met.add(there)
        raise LookupError(f"There is no {what} in the sidebar, but {sorted(met)}.")

    def turn_to(self, page):
        """Scrolls the sidebar so many pages down from its top."""
        if page == self._page == 0:
            return
        yield from self.scroll(4, 100)
        if page:
            yield from self.scroll(5, 12 * page)
        self._page = page

    def top_of(self, what, near=0, page=0):
        """Finds a button, and returns its upper edge in pixels below the window's top: what is below it says nothing of itself."""
        yield from self.find(what, near, page=page)
        x, below, _ = self.observed["found"][what]
        while what in self.under_mouse():
            below -= 3
            self.move(self.sidebar.x + self.sidebar.width * x, self.window.height - below)
            yield 0.1
        return below

    def scroll(self, wheel, times):
        """Turns the wheel over the sidebar: 4 is up, 5 is down."""
        region = self.sidebar
        self.move(region.x + 12, region.y + region.height / 2)
        yield 0.1
        self.click(wheel, times)
        self._page = None
        yield 0.5

    def click_on(self, what, near=0, places=PLACES, page=0):
        """Finds a button and clicks it; see `find`."""
        yield from self.find(what, near, places, page)
        self.click()
        yield 0.3

    def type_into(self, what, text, near=0, page=0):
        """Replaces the text of a field by typing; see `find`."""
        yield from self.click_on(what, near, page=page)
        self.press("ctrl+a")
        self.type(text)
        self.press("Return")

    def click_at(self, below, place):
        """Clicks in the sidebar, so many pixels below the window's top."""
        self.move(self.sidebar.x + self.sidebar.width * place, self.window.height - below)
        yield 0.5
        self.click()
        yield 0.5

    def open(self, below, place):
        """Clicks in the sidebar until something opens below: menus and headers say nothing of themselves."""
        x = self.sidebar.x + self.sidebar.width * place
        for _ in range(5):
            self.move(x, self.window.height - below)
            yield 0.5
            shown = self.pixels(x - 80, below + 20)
            self.click()
            for _ in range(20):
                yield 0.1
                if self.pixels(x - 80, below + 20) != shown:
                    yield 0.5
                    return
        raise TimeoutError(f"Nothing opens {below} pixels below the window's top.")

    def pixels(self, x, below):
        """A small piece of what is shown."""
        piece = f"100x40+{x:.0f}+{below:.0f}"
        command = ["import", "-window", "root", "-crop", piece, "-depth", "8", "rgb:-"]
        return subprocess.run(command, check=True, capture_output=True).stdout

    def click_until(self, place, condition, what):
        """Clicks a place until that has an effect: a window that is just opening loses clicks.

        Args:
            place: Pixels from the window's left and below its top.
            condition: The effect.
            what: It, in words.
        """
        for _ in range(8):
            self.move(place[0], self.window.height - place[1])
            yield 0.4
            self.click()
            for _ in range(15):
                yield 0.1
                if condition():
                    return
        raise TimeoutError(what)

    def drag(self, start, end, name):
        """Drags from one place to another, in pixels from the left and below the top; a screenshot before the end."""
        self.move(start[0], self.window.height - start[1])
        yield 0.4
        subprocess.run(["xdotool", "mousedown", "1"], check=True)
        yield 0.4
        little = 4 if end[0] > start[0] else -4  # at first: a leap out of an icon drags nothing
        step = round((end[0] - start[0] - 5 * little) / 20), round((end[1] - start[1]) / 20)
        for x, y in [(little, 0)] * 5 + [step] * 20:
            subprocess.run(["xdotool", "mousemove_relative", "--", str(x), str(y)], check=True)
            yield 0.1
        yield 0.5
        self.shoot(name)
        subprocess.run(["xdotool", "mouseup", "1"], check=True)
        yield 0.7

    def away(self):
        """Moves the mouse where no button is, so that no tool tip hides what is shown."""
        self.move(self.view.x + 200, self.view.y + 200)
        yield 0.4

    def undo(self):
        """Presses Ctrl+Z over the viewport."""
        yield from self.away()
        self.press("ctrl+z")

    def wait(self, condition, seconds, what):
        """Waits; notes how long each tick of a vibe keeps Blender from its next redraw."""
        self._watch()
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise TimeoutError(f"{what} within {seconds} s")
            yield 0.1

    def _watch(self):
        """Notes the longest tick by what goes on: this thread's time on a core, without what other programs take."""
        from bl_ext.user_default.vibe_render.run.session import Session

        advance = Session.advance
        if advance.__name__ == "watched":
            return

        def watched(session):
            stage, began = session.stage, time.thread_time()
            try:
                return advance(session)
            finally:
                ticks = self.observed.setdefault("ticks", {})
                ticks[stage] = round(max(ticks.get(stage, 0.0), time.thread_time() - began), 3)

        Session.advance = watched
