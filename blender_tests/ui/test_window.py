# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in a real Blender window, by mouse and keyboard. See window_driver.py for the ways that are walked."""

import functools
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from proxy_renderer.blender import extension

REPOSITORY = Path(__file__).resolve().parents[2]
TOOL = REPOSITORY.parent / "shared" / "tools" / "blender-window"
pytestmark = pytest.mark.timeout(2500)  # minutes where others use the machine too
_ATTEMPTS = 3
SIZE = "1920", "1080"  # pixels; what the driver knows about places is for this size
ENGINELESS = ("without_engine", "files")  # ways that find no engine
_BUNDLED = ("numpy", "requests")  # official builds bring them along; Debian's minimal one does not


def _root() -> Path:
    """The folder that Blender is in; skips the test where it cannot be used."""
    if not TOOL.is_file():
        pytest.skip(f"needs {TOOL} (a Blender with a window in a root of its own)")
    if os.geteuid() != 0:
        pytest.skip("needs root, for chroot")
    root = Path(subprocess.run(["bash", TOOL, "path"], capture_output=True, text=True).stdout.strip())
    if not (root / ".ready").exists():
        pytest.skip(f"needs `{TOOL} setup` to have been run")
    return root


def _bundle(root: Path, folder: Path) -> None:
    """Puts the packages that official builds of Blender bring along into a folder."""
    version = os.readlink(root / "usr/bin/python3").removeprefix("python")
    options = ["--python-version", version, "--only-binary=:all:", "--no-compile", "--target", folder]
    done = subprocess.run(
        [sys.executable, "-m", "pip", "install", "-q", *options, *_BUNDLED], capture_output=True
    )
    if done.returncode:
        pytest.skip(f"needs {' and '.join(_BUNDLED)} for Blender's Python {version}, from pip")


@pytest.fixture(scope="module")
def walk(tmp_path_factory):
    """Walks a way, once each; what was seen on it."""
    root = _root()
    user = tmp_path_factory.mktemp("user")
    _bundle(root, user / "scripts" / "addons" / "modules")
    kept = os.environ.get("VIBE_WINDOW_OUT")

    @functools.cache
    def walked(way):
        out = Path(kept) / way if kept else tmp_path_factory.mktemp(way)
        out.mkdir(parents=True, exist_ok=True)
        return _walk(way, out, user)

    return walked


def _walk(way, out, user):
    """A Blender for one way."""
    places = [out, user, *(p for p in (sys.prefix, sys.base_prefix) if not p.startswith("/usr"))]
    environment = {
        **os.environ,
        "SCREEN": "{}x{}x24".format(*SIZE),
        "BLENDER_WINDOW_BIND": ":".join(map(str, places)),
        "BLENDER_USER_RESOURCES": str(user),
        "MESA_SHADER_CACHE_DIR": str(user),  # not one that other programs map and cut meanwhile
        "PYTHONPATH": str(REPOSITORY),  # for the engine; Blender itself must not need it
    }
    environment.setdefault("VIBE_ENGINE", sys.executable)
    blender = ["blender", "--window-geometry", "0", "0", *SIZE, "--factory-startup"]
    if way in ENGINELESS:
        environment["VIBE_ENGINE"] = str(out)
    else:
        blender.append("--offline-mode")  # which the factory's settings are too, but leave to the artist
    driver = ["--python", REPOSITORY / "blender_tests" / "window_driver.py", "--", way]
    for _ in range(_ATTEMPTS):
        done = subprocess.run(
            ["bash", TOOL, "run", *blender, *driver, extension.build(out), out],
            cwd=REPOSITORY, env=environment, capture_output=True, text=True, timeout=1200,
        )  # fmt: skip
        if "libgallium" not in done.stderr:  # Mesa's drawing in software crashes at times, before any of ours
            break
    (out / "blender.log").write_text(done.stdout + done.stderr)
    report = out / "steps.json"
    assert report.is_file(), done.stdout[-3000:] + done.stderr[-3000:]
    seen = json.loads(report.read_text())
    assert "error" not in seen, seen["error"]
    assert "finished" in seen, (done.stdout + done.stderr)[-3000:]
    return seen


def test_stop_cancel_and_esc(walk):
    """What is stopped leaves the best so far and one step to undo; what is given up leaves nothing."""
    seen = walk("ways_out")
    assert seen["prompt"].startswith("misty night")
    for name in ("stop", "esc"):
        assert seen[f"{name}_takes_the_best"]
    for name in ("stop", "cancel", "esc", "esc_twice"):
        assert seen[f"{name}_restores"], name


def test_preferences_find_and_try_the_engine(walk):
    """The engine is found by itself, and answers."""
    assert "answers" in walk("ways_out")["engine"]


def test_extension_needs_no_engine_code(walk):
    """The installed extension uses the schema that was copied into it."""
    assert walk("ways_out")["schema_is_the_copy"]


def test_blender_stays_responsive(walk):
    """Nothing but the renders that the panel announces keeps Blender for long."""
    ticks = dict(walk("ways_out")["ticks"])
    assert ticks.pop("Rendering an anchor") > 0.0
    assert {"Reading the scene", "Looking for the look"} <= set(ticks)
    assert max(ticks.values()) < 0.5, ticks  # .1 on an idle machine


def test_vibe_changes_what_it_lists(walk):
    """The prompt leads to a result that is in the scene and in the list; undo, redo and Revert are exact."""
    seen = walk("choosing")
    assert seen["failure"] == ""
    assert seen["changed"]
    assert seen["listed"]
    for way_back in ("undo", "redo", "revert"):
        assert seen[f"{way_back}_restores"], way_back


def test_before_after_strength_and_variants(walk):
    """They show in the scene itself."""
    seen = walk("choosing")
    for shown in ("before_shows_before", "after_shows_after", "strength_dims", "variant_differs"):
        assert seen[shown], shown


def test_what_is_locked_stays(walk):
    """A single value and a group, each with a click, and Again."""
    seen = walk("choosing")
    assert seen["again"]
    assert seen["locked_stays"]
    assert seen["locked_changed"] == []


def test_a_preset_is_saved_found_and_put_on_another_scene(walk):
    """Keep keeps; the picture grid finds by words; Apply says what it changed, and Revert takes it back."""
    seen = walk("presets")
    assert seen["kept"]
    assert seen["saved"] == seen["chosen"]
    assert seen["applied"]
    assert seen["preset_revert_restores"]


def test_without_an_engine_the_panel_says_so_and_the_rest_works(walk):
    """Earlier prompts, locks, a preset, compare, strength, the render properties; nothing is downloaded offline."""
    seen = walk("without_engine")
    assert seen["vibe_it_waits"]
    assert seen["recalled"] == "noir, one hard light"
    assert seen["unlocked"]
    assert seen["preset"] == "Moonlight"
    assert 0.3 < seen["strength"] < 0.9
    assert len(seen["powers_on_the_way"]) > 5, "the light follows while the slider is dragged"
    for shown in ("dimmed", "before_shows_before", "rendered", "revert_restores"):
        assert seen[shown], shown
    assert "no Vibe engine" in seen["tested"]
    assert seen["offline_sets_up_nothing"]


def test_presets_and_looks_as_files(walk):
    """A preset is saved beside ours, renamed, exported, deleted and imported; assets come back by drag and drop."""
    seen = walk("files")
    assert seen["saved"] == "Moonlight 2"
    assert seen["renamed"] == seen["imported"] == "Blue Night"
    assert seen["exported"] == ["blue-night.jpg", "blue-night.json"]
    assert seen["deleted"]
    assert set(seen["assets"]) == {"Moonlight Light Rig", "Moonlight Grade", "Moonlight World"}
    assert seen["rig"] == ["LIGHT", "LIGHT"]


def test_shared_materials_are_asked_about(walk):
    """Both answers are followed."""
    seen = walk("questions")
    assert seen["asked_about"] == ["Monkey"]
    assert seen["answer_all"]
    assert seen["answer_single"]


def test_windows_files_and_the_end(walk):
    """A second window may come and go; another file, or the end of Blender, ends the vibe, and no engine stays."""
    seen = walk("ends")
    assert seen["second_window_greys_it_out"]
    assert seen["closing_it_changes_nothing"]
    assert seen["load_ends_it"]
    until = time.monotonic() + 60.0
    while _lives(seen["last_engine"]) and time.monotonic() < until:
        time.sleep(0.5)
    assert not _lives(seen["last_engine"])


def _lives(pid):
    return Path(f"/proc/{pid}").exists() and "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text()
