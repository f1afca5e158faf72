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
pytestmark = [pytest.mark.slow, pytest.mark.timeout(2500)]  # minutes where others use the machine too
_ATTEMPTS = 3
SIZE = "1920", "1080"  # pixels; what the driver knows about places is for this size
SIZES = {"tour": ("1440", "900"), "tour_double": ("2880", "1800")}  # of ways that are not of that size
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
        "SCREEN": "{}x{}x24".format(*(size := SIZES.get(way, SIZE))),
        "BLENDER_WINDOW_BIND": ":".join(map(str, places)),
        "BLENDER_USER_RESOURCES": str(user),
        "MESA_SHADER_CACHE_DIR": str(user),  # not one that other programs map and cut meanwhile
        "PYTHONPATH": str(REPOSITORY),  # for the engine; Blender itself must not need it
    }
    environment.setdefault("VIBE_ENGINE", sys.executable)
    blender = ["blender", "--window-geometry", "0", "0", *size, "--factory-startup"]
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
    observed = json.loads(report.read_text())
    assert "error" not in observed, observed["error"]
    assert "finished" in observed, (done.stdout + done.stderr)[-3000:]
    return observed


def test_stop_cancel_and_esc(walk):
    """What is stopped leaves the best so far and one step to undo; what is given up leaves nothing."""
    observed = walk("ways_out")
    assert observed["prompt"].startswith("misty night")
    for name in ("stop", "esc"):
        assert observed[f"{name}_takes_the_best"]
    for name in ("stop", "cancel", "esc", "esc_twice"):
        assert observed[f"{name}_restores"], name


def test_a_first_look_comes_before_the_search(walk):
    """It is in the scene and in the panel; how quickly is printed, for machines differ."""
    looks = walk("ways_out")["first_looks"]
    print("seconds to the values and to the picture, the first time with a cold engine:", looks)
    assert len(looks) == 4


def test_live_looks_come_while_words_are_typed(walk):
    """Enter searches from there; Esc takes all of it away. How quickly looks come is printed."""
    observed = walk("live")
    print("seconds from the last letter to its look:", observed["live_looks"])
    for seen in ("live_shows", "live_stays_on_enter", "live_restores", "live_escape_restores"):
        assert observed[seen], seen


def test_a_click_on_a_word_says_what_it_describes(walk):
    """The menu's last line leaves the word out."""
    observed = walk("words")
    (told,) = observed["told"]
    word, _, target = told.partition("=")
    assert target == "not used"
    assert observed["states"][word] == "left out"
    assert {"guessed", "left out"} <= set(observed["unknown"].values())
    assert observed["recalled"] == observed["told"]


@pytest.mark.parametrize("way", ["tour", "tour_double"])
def test_the_decision_is_in_sight(walk, way):
    """At 900 pixels, and at twice the size of everything: every word that is measured is visible, and Keep needs no scrolling."""
    observed = walk(way)
    assert observed["visible"]
    assert observed["missed"] == []
    _, below, page = observed["keep"]
    assert page == 0
    assert below < int(SIZES[way][1]) * 0.85


def test_preferences_find_and_try_the_engine(walk):
    """The engine is found by itself, and answers."""
    assert "answers" in walk("ways_out")["engine"]


def test_extension_needs_no_engine_code(walk):
    """The installed extension uses the schema that was copied into it."""
    assert walk("ways_out")["schema_is_the_copy"]


def test_blender_stays_responsive(walk):
    """Nothing but the renders that the panel announces keeps Blender for long."""
    ticks = dict(walk("ways_out")["ticks"])
    assert ticks.pop("Comparing with Cycles") > 0.0
    assert {"Reading the scene", "Optimizing"} <= set(ticks)
    assert max(ticks.values()) < 0.5, ticks  # .1 on an idle machine


def test_vibe_changes_what_it_lists(walk):
    """The prompt leads to a result that is in the scene and in the list; undo, redo and Revert are exact."""
    observed = walk("choosing")
    assert observed["failure"] == ""
    assert observed["changed"]
    assert observed["listed"]
    for way_back in ("undo", "redo", "revert"):
        assert observed[f"{way_back}_restores"], way_back


def test_before_after_strength_and_variants(walk):
    """They show in the scene itself."""
    observed = walk("choosing")
    for shown in ("before_shows_before", "after_shows_after", "strength_dims", "variant_differs"):
        assert observed[shown], shown


def test_what_is_locked_stays(walk):
    """A single value and a group, each with a click, and Again."""
    observed = walk("choosing")
    assert observed["again"]
    assert observed["locked_stays"]
    assert observed["locked_changed"] == []


def test_a_preset_is_saved_found_and_put_on_another_scene(walk):
    """Keep keeps; the picture grid finds by words; Apply says what it changed, and Revert takes it back."""
    observed = walk("presets")
    assert observed["kept"]
    assert observed["saved"] == observed["chosen"]
    assert observed["applied"]
    assert observed["preset_revert_restores"]


def test_without_an_engine_the_panel_says_so_and_the_rest_works(walk):
    """Earlier prompts, locks, a preset, compare, strength, Revert; nothing is downloaded offline."""
    observed = walk("without_engine")
    assert observed["vibe_it_waits"]
    assert observed["recalled"] == "noir, one hard light"
    assert observed["unlocked"]
    assert observed["preset"] == "Moonlight"
    assert 0.3 < observed["strength"] < 0.9
    assert len(observed["powers_on_the_way"]) > 5, "the light follows while the slider is dragged"
    for shown in ("dimmed", "before_shows_before", "rendered", "revert_restores"):
        assert observed[shown], shown
    assert "no Vibe engine" in observed["tested"]
    assert observed["offline_sets_up_nothing"]
    assert observed["asks_before_it_downloads"]
    assert observed["esc_sets_up_nothing"]


def test_presets_and_looks_as_files(walk):
    """A preset is saved beside ours, renamed, exported, deleted and imported; assets come back by drag and drop."""
    observed = walk("files")
    assert observed["saved"] == "Moonlight 2"
    assert observed["renamed"] == observed["imported"] == "Blue Night"
    assert observed["exported"] == ["blue-night.jpg", "blue-night.json"]
    assert observed["deleted"]
    assert set(observed["assets"]) == {"Moonlight Light Rig", "Moonlight Grade", "Moonlight World"}
    assert observed["rig"] == ["LIGHT", "LIGHT"]


def test_a_picture_is_given_instead_of_words(walk):
    """A file whose path is typed is what the look comes from; an image of the .blend and a render slot are taken as well."""
    observed = walk("still")
    assert not observed["like_failure"]
    assert observed["like_changes"]
    assert all("dusk.png" in word for word in observed["like_words"])
    assert observed["like_words"]
    assert observed["like_image"] == "dusk.png"
    assert observed["like_slot"] == "render slot 1"


def test_a_further_sentence_and_its_steps(walk):
    """What is typed goes on from the result; a step is shown and switched off with a click, and undone by one undo step."""
    observed = walk("further")
    assert observed["failure"] == ""
    assert observed["sentences"][1:] == ["much darker"]
    for seen in ("further_changes", "show_restores", "undo_restores", "off_restores"):
        assert observed[seen], seen


def test_a_light_is_mixed_by_its_slider(walk):
    """The image follows the slider; Apply is one undo step; the compositor has the light group until Revert."""
    observed = walk("light_mix")
    (name,) = observed["factor"]
    assert observed["images_on_the_way"] > 3
    assert observed["changed"] == [f"{name}.energy", f"{name}.color"]
    assert observed["light_groups"] == [name]
    for seen in ("scene_stays", "undo_restores", "revert_restores"):
        assert observed[seen], seen


def test_shared_materials_are_asked_about(walk):
    """Both answers are followed."""
    observed = walk("questions")
    assert observed["asked_about"] == ["Monkey"]
    assert observed["answer_all"]
    assert observed["answer_single"]


def test_windows_files_and_the_end(walk):
    """A second window may come and go; another file, or the end of Blender, ends the vibe, and no engine stays."""
    observed = walk("ends")
    assert observed["second_window_grays_it_out"]
    assert observed["closing_it_changes_nothing"]
    assert observed["load_ends_it"]
    until = time.monotonic() + 60.0
    while _lives(observed["last_engine"]) and time.monotonic() < until:
        time.sleep(0.5)
    assert not _lives(observed["last_engine"])


def _lives(pid):
    return Path(f"/proc/{pid}").exists() and "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text()
