# SPDX-License-Identifier: GPL-3.0-or-later
"""Set Up Engine: a real environment made by real pip, from a wheel on disk in place of the package index."""

import time
import zipfile
from pathlib import Path

import pytest
from vibe_render.engine import find, setup

from proxy_renderer.schema import VibeError


@pytest.fixture
def wheel(tmp_path):
    """A package that has what the engine's environment is asked for."""
    path = tmp_path / "stand_in-1.0-py3-none-any.whl"
    record = "stand_in-1.0.dist-info"
    with zipfile.ZipFile(path, "w") as file:
        for module in find._NEEDED:
            file.writestr(f"{module}/__init__.py", "")
        file.writestr(f"{record}/METADATA", "Metadata-Version: 2.1\nName: stand-in\nVersion: 1.0\n")
        file.writestr(f"{record}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        file.writestr(f"{record}/RECORD", "")
    return path


@pytest.fixture(autouse=True)
def offline(monkeypatch):
    monkeypatch.setenv("PIP_NO_INDEX", "1")


@pytest.mark.slow
def test_makes_an_environment_that_is_found(wheel, tmp_path):
    environment = setup.EngineSetup(tmp_path / "engine", [str(wheel)])
    texts = set()
    while environment.running:
        texts.add(environment.text)
        time.sleep(0.02)
    environment.finish()
    assert "Making a Python environment" in texts
    python = find.find_python(str(tmp_path / "engine"))
    assert find.has_engine(python)
    assert Path(python).is_relative_to(tmp_path)


def test_a_failure_says_why_and_leaves_nothing(tmp_path):
    (tmp_path / "file").write_text("")
    environment = setup.EngineSetup(tmp_path / "file" / "engine", ["no-such-package"])
    with pytest.raises(VibeError, match="Making a Python environment failed"):
        environment.finish()
    assert (tmp_path / "file").read_text() == ""


def test_cancel_leaves_nothing(wheel, tmp_path):
    environment = setup.EngineSetup(tmp_path / "engine", [str(wheel)])
    while not (tmp_path / "engine").exists() and environment.running:
        time.sleep(0.02)
    environment.cancel()
    with pytest.raises(VibeError, match="Canceled"):
        environment.finish()
    assert not (tmp_path / "engine").exists()


def test_downloads_are_followed():
    """Lines as pip writes them."""
    environment = object.__new__(setup.EngineSetup)
    environment._follow("Collecting torch>=2.5\n")
    assert environment.text == "Looking for torch"
    environment._follow("  Downloading torch-2.15.0-cp313-cp313-manylinux_2_28_x86_64.whl (901.2 MB)\n")
    assert environment.text == "Downloading torch (901.2 MB)"
    environment._follow("Progress 50 of 200\n")
    assert environment.fraction == 0.25
    environment._follow("Installing collected packages: numpy, torch\n")
    assert environment.text == "Installing 2 packages, for some minutes"


@pytest.mark.parametrize(
    ("line", "meaning"),
    [
        ("ERROR: Could not install: [Errno 28] No space left on device", "room on the disk"),
        (
            "WARNING: Retrying after NewConnectionError: Temporary failure in name resolution",
            "cannot be reached",
        ),
        ("ERROR: No matching distribution found for x", "No matching distribution"),
    ],
)
def test_complaints_become_one_clear_line(line, meaning):
    assert meaning in str(setup._failure("Installing", [line]))


def test_a_clone_says_what_to_do_instead():
    with pytest.raises(VibeError, match="does not carry the engine"):
        setup.requirements()
