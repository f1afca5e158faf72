# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts a real Blender with a window for one way through the panel. See window_driver.py for the ways."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from proxy_renderer.blender import extension

REPOSITORY = Path(__file__).resolve().parents[1]
TOOL = REPOSITORY.parent / "shared" / "tools" / "blender-window"
_ATTEMPTS = 3
SIZE = "1200", "1080"  # pixels; drawing in software takes most of a way's time
SIZES = {
    "tour": ("1440", "900"),
    "tour_double": ("1800", "1800"),
    # What is beside the panel has its place at this size.
    "files": ("1920", "1080"),
    "without_engine": ("1920", "1080"),
}
"""Of ways that are not of that size."""
ENGINELESS = ("without_engine", "files")  # ways that find no engine
_BUNDLED = ("numpy", "requests")  # official builds bring them along; Debian's minimal one does not


def window_root() -> Path:
    """The folder that Blender is in; skips the test where it cannot be used."""
    if not TOOL.is_file():
        pytest.skip(f"needs {TOOL} (a Blender with a window in a root of its own)")
    if os.geteuid() != 0:
        pytest.skip("needs root, for chroot")
    root = Path(subprocess.run(["bash", TOOL, "path"], capture_output=True, text=True).stdout.strip())
    if not (root / ".ready").exists():
        pytest.skip(f"needs `{TOOL} setup` to have been run")
    return root


def bundle_packages(root: Path, folder: Path) -> None:
    """Puts the packages that official builds of Blender bring along into a folder."""
    version = os.readlink(root / "usr/bin/python3").removeprefix("python")
    options = ["--python-version", version, "--only-binary=:all:", "--no-compile", "--target", folder]
    done = subprocess.run([sys.executable, "-m", "pip", "install", "-q", *options, *_BUNDLED], capture_output=True)
    if done.returncode:
        pytest.skip(f"needs {' and '.join(_BUNDLED)} for Blender's Python {version}, from pip")


def walk_way(way, out, user):
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
