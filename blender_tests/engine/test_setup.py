# SPDX-License-Identifier: GPL-3.0-or-later
"""Set Up Engine: a real environment made by real pip, from wheels on disk in place of the package indices."""

import functools
import http.server
import os
import shutil
import subprocess
import sys
import threading
import time
import zipfile
from collections import namedtuple
from dataclasses import replace
from pathlib import Path

import pytest
from vibe_render.engine import setup

from proxy_renderer.schema import VibeError


def write_wheel(folder, name, version, modules=(), needs=()):
    """A package of empty modules."""
    folder.mkdir(parents=True, exist_ok=True)
    path, record = folder / f"{name}-{version}-py3-none-any.whl", f"{name}-{version}.dist-info"
    with zipfile.ZipFile(path, "w") as file:
        for module in modules:
            file.writestr(f"{module}/__init__.py", "")
        lines = [f"Name: {name}", f"Version: {version}", *(f"Requires-Dist: {need}" for need in needs)]
        file.writestr(f"{record}/METADATA", "\n".join(["Metadata-Version: 2.1", *lines, ""]))
        file.writestr(f"{record}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        file.writestr(f"{record}/RECORD", "")
    return path


@pytest.fixture
def wheel(tmp_path):
    """A package that has what the engine's environment is asked for."""
    return write_wheel(tmp_path, "stand_in", "1.0", setup._NEEDED)


@pytest.fixture(autouse=True)
def offline(monkeypatch):
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.delenv("PIP_FIND_LINKS", raising=False)


@pytest.fixture(autouse=True)
def roomy(monkeypatch):
    """The stand-ins are empty: they need none of the room that the real packages take."""
    leave_free(monkeypatch, 100e9)


def leave_free(monkeypatch, free):
    usage = namedtuple("usage", "total used free")
    monkeypatch.setattr(setup.shutil, "disk_usage", lambda path: usage(200e9, 200e9 - free, free))


def installed(environment):
    return {path.name.removesuffix(".dist-info") for path in environment.glob("lib/*/site-packages/*.dist-info")}


@pytest.mark.slow
def test_makes_an_environment_that_is_found(wheel, tmp_path):
    environment = setup.EngineSetup(tmp_path / "engine", [str(wheel)], setup.CUDA)
    texts = set()
    while not environment.work.done():
        texts.add(environment.text)
        time.sleep(0.02)
    environment.work.result()
    assert "Making a Python environment" in texts
    python = setup.find_python(str(tmp_path / "engine"))
    assert setup.has_engine(python)
    assert Path(python).is_relative_to(tmp_path)


@pytest.fixture
def folders(tmp_path):
    """Folders of wheels in place of torch's own index and of the Python Package Index, whose torch is newer."""
    write_wheel(tmp_path / "own", "torch", "2.15.0+cpu", ["torch"])
    write_wheel(tmp_path / "own", "torchvision", "0.30.0+cpu", needs=["torch==2.15.0"])
    usual = tmp_path / "usual"
    write_wheel(usual, "torch", "2.16.0", ["torch"], needs=["nvidia-cudnn"])
    write_wheel(usual, "torchvision", "0.31.0", needs=["torch==2.16.0"])
    write_wheel(usual, "nvidia_cudnn", "9.0")
    others = [module for module in setup._NEEDED if module != "torch"]
    write_wheel(usual, "others", "1.0", others, needs=["torchvision"])
    return tmp_path / "own", usual


def as_index(folder):
    """The address of an index, as pip reads it, with the folder's wheels in it."""
    pages = folder.with_name(f"{folder.name}_index")
    for path in folder.glob("*.whl"):
        page = pages / path.name.partition("-")[0].replace("_", "-") / "index.html"
        page.parent.mkdir(parents=True)
        page.write_text(f'<a href="{path.as_uri()}">{path.name}</a>')
    return pages.as_uri()


def test_torch_for_the_processor_comes_from_its_own_index(folders, tmp_path, monkeypatch):
    own, usual = map(as_index, folders)
    monkeypatch.delenv("PIP_NO_INDEX")
    monkeypatch.setenv("PIP_INDEX_URL", usual)
    build = replace(setup.CPU, index=own)
    setup.EngineSetup(tmp_path / "engine", ["torch>=2.5", "others"], build).work.result()
    assert installed(tmp_path / "engine") >= {"torch-2.15.0+cpu", "torchvision-0.30.0+cpu", "others-1.0"}
    assert not [name for name in installed(tmp_path / "engine") if name.startswith("nvidia")]


@pytest.mark.slow
@pytest.mark.parametrize("build", [setup.CPU, setup.CUDA])
def test_a_folder_of_wheels_serves_instead_of_every_index(folders, tmp_path, monkeypatch, build):
    """A studio without a network: pip's own settings `no-index` and `find-links`."""
    own, usual = folders
    shutil.copy(next(usual.glob("others*")), own)
    monkeypatch.setenv("PIP_FIND_LINKS", str(own if build is setup.CPU else usual))
    setup.EngineSetup(tmp_path / "engine", ["torch>=2.5", "others"], build).work.result()
    assert ("nvidia_cudnn-9.0" in installed(tmp_path / "engine")) == (build is setup.CUDA)


def test_a_failure_says_why_and_leaves_nothing(tmp_path):
    (tmp_path / "file").write_text("")
    environment = setup.EngineSetup(tmp_path / "file" / "engine", ["no-such-package"], setup.CUDA)
    with pytest.raises(VibeError, match="Making a Python environment failed"):
        environment.work.result()
    assert (tmp_path / "file").read_text() == ""


def test_cancel_leaves_nothing_new_and_the_older_engine_whole(wheel, tmp_path):
    (tmp_path / "engine").mkdir()
    (tmp_path / "engine" / "kept").touch()
    (tmp_path / "engine.part").mkdir()  # of a Blender that was killed
    (tmp_path / "engine.part" / "half").touch()
    environment = setup.EngineSetup(tmp_path / "engine", [str(wheel)], setup.CUDA)
    while not (tmp_path / "engine.part" / "bin").exists() and not environment.work.done():
        time.sleep(0.02)
    environment.cancel()
    with pytest.raises(VibeError, match="Canceled"):
        environment.work.result()
    assert (tmp_path / "engine" / "kept").exists()
    assert not (tmp_path / "engine.part").exists()


def test_a_finished_environment_replaces_the_older_one_and_runs_there(tmp_path):
    for name in ("engine", "engine.part"):
        subprocess.run([setup._python(), "-m", "venv", "--without-pip", tmp_path / name], check=True)
    (tmp_path / "engine" / "old").touch()
    setup._replace(tmp_path / "engine", tmp_path / "engine.part")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["engine"]
    assert not (tmp_path / "engine" / "old").exists()
    code = "import sys; print(sys.prefix)"
    said = subprocess.check_output([setup.python_of(tmp_path / "engine"), "-c", code], text=True)
    assert said.strip() == str(tmp_path / "engine")


def test_a_full_disk_is_said_before_anything_is_downloaded(tmp_path, monkeypatch):
    leave_free(monkeypatch, 2e9)
    environment = setup.EngineSetup(tmp_path / "engine", [], setup.CUDA)
    with pytest.raises(VibeError, match=r"2\.0 GB are free, the engine takes 5\.8 GB"):
        environment.work.result()
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize("trace", ["proc/driver/nvidia/gpus/0000:01:00.0", "usr/lib/wsl/lib/libcuda.so.1"])
def test_a_card_is_seen_by_the_traces_of_its_driver(tmp_path, trace):
    assert not setup.has_nvidia_card(tmp_path)
    (tmp_path / trace).parent.mkdir(parents=True)
    assert not setup.has_nvidia_card(tmp_path)
    (tmp_path / trace).touch()
    assert setup.has_nvidia_card(tmp_path)


@pytest.mark.parametrize(
    ("system", "card", "build"),
    [("linux", True, "CUDA"), ("linux", False, "CPU"), ("darwin", False, "USUAL"), ("win32", False, "USUAL")],
)
def test_each_computer_gets_the_build_that_suits_it(monkeypatch, system, card, build):
    monkeypatch.setattr(setup.sys, "platform", system)
    monkeypatch.setattr(setup, "has_nvidia_card", lambda: card)
    assert setup.suggested() == build


def test_what_is_downloaded_is_said_with_its_source_and_size(tmp_path, monkeypatch):
    monkeypatch.setattr(setup.sys, "platform", "linux")
    monkeypatch.setattr(setup, "has_nvidia_card", lambda: False)
    small, large = (" ".join(setup.download_text(build, tmp_path)) for build in setup.choices().values())
    assert {"download.pytorch.org", "pypi.org"} <= set(small.replace(",", "").replace("(", "").split())
    assert f"{setup.CPU.download} GB to download" in small
    assert f"{setup.CUDA.disk} GB in {tmp_path}" in large
    assert "No NVIDIA card was found" in large


@pytest.mark.slow
def test_a_download_shows_its_size_and_how_far_it_is(wheel, tmp_path, monkeypatch):
    """From a folder of wheels behind a server on the loopback address."""
    with zipfile.ZipFile(wheel, "a") as file:
        file.writestr("torch/weights.bin", os.urandom(3_000_000))
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=tmp_path)
    seen = []
    follow = setup.EngineSetup._follow

    def followed(environment, line):
        follow(environment, line)
        seen.append((environment.text, environment.fraction))

    monkeypatch.setattr(setup.EngineSetup, "_follow", followed)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        monkeypatch.setenv("PIP_FIND_LINKS", f"http://127.0.0.1:{server.server_port}/")
        setup.EngineSetup(tmp_path / "engine", ["stand-in"], setup.CUDA).work.result()
        server.shutdown()
    assert ("Downloading stand_in (3.0 MB)", 0.0) in seen
    if sys.version_info >= (3, 13):  # older Pythons bring a pip that reports no progress
        assert ("Downloading stand_in (3.0 MB)", 1.0) in seen


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
            "The package index cannot be reached",
        ),
        (
            "WARNING: Retrying after ProxyError(HTTPSConnectionPool(host='wheels.example', port=443))",
            "wheels.example cannot be reached",
        ),
        ("ERROR: No matching distribution found for x", "No matching distribution"),
    ],
)
def test_complaints_become_one_clear_line(line, meaning):
    assert meaning in str(setup._failure("Installing", [line]))


def test_a_clone_says_what_to_do_instead():
    with pytest.raises(VibeError, match="does not carry the engine"):
        setup.requirements()
