# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in a real Blender window, by mouse and keyboard. See window_driver.py for the way that is walked."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from proxy_renderer import extension

REPOSITORY = Path(__file__).resolve().parents[1]
TOOL = REPOSITORY.parent / "shared" / "tools" / "blender-window"
pytestmark = pytest.mark.timeout(2500)  # minutes where others use the machine too
_ATTEMPTS = 3
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
def walked(tmp_path_factory):
    """Walks the way once; what was seen, and the folder of the screenshots."""
    root = _root()
    out = Path(os.environ.get("VIBE_WINDOW_OUT") or tmp_path_factory.mktemp("window"))
    out.mkdir(parents=True, exist_ok=True)
    user = tmp_path_factory.mktemp("user")
    _bundle(root, user / "scripts" / "addons" / "modules")
    places = [out, user, *(p for p in (sys.prefix, sys.base_prefix) if not p.startswith("/usr"))]
    environment = {
        **os.environ,
        "BLENDER_WINDOW_BIND": ":".join(map(str, places)),
        "BLENDER_USER_RESOURCES": str(user),
        "MESA_SHADER_CACHE_DIR": str(user),  # not one that other programs map and cut meanwhile
        "PYTHONPATH": str(REPOSITORY),  # for the engine; Blender itself must not need it
    }
    environment.setdefault("VIBE_ENGINE", sys.executable)
    command = [
        "blender",
        "--window-geometry",
        "0",
        "0",
        "1600",
        "1000",
        "--factory-startup",
        "--offline-mode",
    ]
    driver = ["--python", REPOSITORY / "blender_tests" / "window_driver.py", "--", extension.build(out), out]
    for _ in range(_ATTEMPTS):
        done = subprocess.run(
            ["bash", TOOL, "run", *command, *driver],
            cwd=REPOSITORY, env=environment, capture_output=True, text=True, timeout=2400,
        )  # fmt: skip
        if "libgallium" not in done.stderr:  # Mesa's drawing in software crashes at times, before any of ours
            break
    (out / "blender.log").write_text(done.stdout + done.stderr)
    report = out / "steps.json"
    assert report.is_file(), done.stdout[-3000:] + done.stderr[-3000:]
    return json.loads(report.read_text()), out


def test_whole_way(walked):
    """Nothing on the way failed, and there is a screenshot of each step."""
    seen, out = walked
    assert "error" not in seen, seen["error"]
    assert "finished" in seen, (out / "blender.log").read_text()[-3000:]
    assert len(list(out.glob("*.png"))) >= 12


def test_preferences_find_and_try_the_engine(walked):
    """The engine is found by itself, and answers."""
    assert "answers" in walked[0]["engine"]


def test_vibe_changes_what_it_lists(walked):
    """The typed prompt leads to a result that is in the scene and in the list."""
    seen, _ = walked
    assert seen["prompt"].startswith("misty night")
    assert seen["failure"] == ""
    assert seen["changed"]
    assert seen["listed"]


def test_esc_takes_the_best_so_far(walked):
    """The look that was best when Esc was pressed is in the scene."""
    assert walked[0]["esc_takes_the_best"]


@pytest.mark.parametrize("way_back", ["esc_undo", "cancel", "undo", "redo", "revert"])
def test_way_back_is_exact(walked, way_back):
    """Undo, Cancel and Revert lead back to the same values; redo to the vibe's."""
    assert walked[0][f"{way_back}_restores"]


def test_before_and_after(walked):
    """Before shows the values as they were, in the scene itself."""
    assert walked[0]["compare_shows_before"]


def test_blender_stays_responsive(walked):
    """Nothing but what the panel announces keeps Blender; a redraw in software, as here, takes a while itself."""
    pauses = walked[0]["pauses"]
    announced = {"Reading the scene", "Rendering an anchor"}
    assert "Looking for the look" in pauses
    assert max(seconds for stage, seconds in pauses.items() if stage not in announced) < 1.0, pauses


def test_extension_needs_no_engine_code(walked):
    """The installed extension uses the schema that was copied into it."""
    assert walked[0]["schema_is_the_copy"]
