# SPDX-License-Identifier: GPL-3.0-or-later
"""An artist's way with files: presets saved, renamed, exported, deleted and imported.

A look is exported as LUT and as assets, which are dragged back from the Asset Browser. See window_driver.py.
"""

import shutil
from pathlib import Path

import bpy
from window_steps import confirm, header

NAME = "Blue Night"
PRESETS = 68
"""The header of the presets, below that of Save Preset."""


def files(screen):
    """A preset of ours is put on the scene; then all that can be done with files, in a folder beside the screenshots."""
    from bl_ext.user_default.vibe_render.looks import library

    folder = screen.out / "files"
    for old in (folder, library.preset_folder()):
        shutil.rmtree(old, ignore_errors=True)
    folder.mkdir()
    with screen.over(screen.view):
        bpy.ops.vibe.preset_apply(path=str(library.find_preset("Moonlight").path))
    yield from screen.away()
    yield from a_preset_of_ones_own(screen)
    yield from handed_on(screen, folder)
    yield from exports(screen, folder)
    yield from dragged_back(screen, folder)


def a_preset_of_ones_own(screen):
    """Saved under a name that ours has, and renamed by typing."""
    from bl_ext.user_default.vibe_render.looks import library

    yield from header(screen, PRESETS, "vibe.preset_save", 638)

    held = bpy.context.window_manager.vibe_presets
    ours = held.chosen
    yield from screen.click_on("vibe.preset_save", 638, (0.7,))
    yield 0.7
    screen.shoot("save")
    yield from confirm(screen, lambda: held.chosen != ours, "the preset is saved")
    screen.observed["saved"] = library.preset_at(held.chosen).name
    saved = held.chosen
    yield from choose(screen, 24)
    yield 0.5
    screen.press("ctrl+a")
    screen.type(NAME)
    yield 0.5
    screen.shoot("rename")
    yield from confirm(screen, lambda: held.chosen != saved, "the preset is renamed")
    screen.observed["renamed"] = library.preset_at(held.chosen).name
    yield from screen.away()
    screen.shoot("renamed")


def handed_on(screen, folder):
    """Exported, deleted, imported."""
    from bl_ext.user_default.vibe_render.looks import library

    held = bpy.context.window_manager.vibe_presets
    yield from choose(screen, 44)
    yield from file_dialog(screen, folder, "export")
    screen.observed["exported"] = sorted(p.name for p in folder.iterdir())
    yield from choose(screen, 73)
    yield 0.7
    screen.shoot("delete")
    yield from confirm(screen, lambda: not held.chosen, "the preset is deleted")
    screen.observed["deleted"] = not any(look.name == NAME for look in library.all_looks())
    yield from presets_menu(screen, 24)
    yield from file_dialog(screen, folder, "import", pick=True)
    yield from screen.wait(lambda: held.chosen, 30, "the preset is imported")
    screen.observed["imported"] = library.preset_at(held.chosen).name
    yield from screen.away()
    screen.shoot("imported")


def exports(screen, folder):
    """The look as a LUT and as assets."""
    for below, name, file in ((95, "lut", "moonlight.cube"), (74, "assets", "moonlight.blend")):
        yield from presets_menu(screen, below)
        yield from file_dialog(screen, folder, name)
        yield from screen.wait((folder / file).is_file, 120, file)
        yield 1.0
        screen.shoot(f"{name}_exported")
    with bpy.data.libraries.load(str(folder / "moonlight.blend"), assets_only=True) as (there, _):
        screen.observed["assets"] = [*there.collections, *there.node_groups, *there.worlds]


def dragged_back(screen, folder):
    """The light rig and the world are dragged from the Asset Browser into the viewport."""
    library = bpy.context.preferences.filepaths.asset_libraries.new(name="Looks", directory=str(folder))
    screen.look("PROPERTIES")
    screen.area.ui_type = "ASSETS"
    yield 1.0
    space = screen.area.spaces.active
    space.params.asset_library_reference, space.show_region_toolbar = library.name, False
    yield 2.0
    screen.shoot("asset_browser")
    scene, there = bpy.context.scene, set(bpy.context.scene.objects)
    yield from screen.drag((1747, 302), (700, 800), "drag_rig")
    yield from screen.wait(lambda: set(scene.objects) - there, 30, "the light rig arrives")
    (rig,) = set(scene.objects) - there
    yield from screen.drag((1635, 450), (500, 300), "drag_world")
    yield from screen.wait(lambda: scene.world.name == "Moonlight World", 30, "the world arrives")
    screen.observed["rig"] = [light.type for light in rig.instance_collection.objects]
    screen.look()
    yield from screen.away()
    screen.shoot("dragged_back")


def choose(screen, below):
    """An entry of the chosen preset's menu: so many pixels below its button."""
    row = (yield from screen.top_of("vibe.preset_apply", 851, page=1)) - 59
    yield from screen.open(row, 0.815)
    yield from screen.click_at(row + below, 0.98)


def presets_menu(screen, below):
    """An entry of the menu of all presets: so many pixels below its button."""
    row = (yield from screen.top_of("vibe.preset_save", 638)) + PRESETS
    yield from screen.open(row, 0.79)
    yield from screen.click_at(row + below, 0.98)


def file_dialog(screen, folder: Path, name, pick=False):
    """Types a folder, clicks the first file where one is wanted, and then the button that does it."""
    windows = bpy.context.window_manager.windows
    yield from screen.wait(lambda: len(windows) == 2, 30, f"the dialog of {name}")
    yield 1.0
    screen.look("FILE_BROWSER")
    params, window = screen.area.spaces.active.params, screen.window
    screen.move(window.width / 2, window.height - 21)
    yield 0.4
    screen.click()
    yield 0.4
    screen.press("ctrl+a")
    screen.type(str(folder))
    screen.press("Return")
    yield from screen.wait(lambda: Path(params.directory.decode()) == folder, 30, "the folder")
    if pick:
        yield from screen.click_until((396, 82), lambda: params.filename, "a file is picked")
    yield 0.7
    screen.shoot(name)
    done = window.width - 73, window.height - 22
    yield from screen.click_until(done, lambda: len(windows) == 1, f"{name} is done")
    screen.look()
    yield from screen.away()
