# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's zip: built and validated by Blender's tool, and working without the engine's code."""

import shutil
import subprocess
import sys
import zipfile

import pytest
from reach import unreachable

from proxy_renderer.blender import extension
from proxy_renderer.schema import VibeError, schema_hash

# Run where neither the clone nor an installed vibe-render can be imported.
ALONE = """
import sys
folder, digest = sys.argv[1:]
class Ban:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in ("proxy_renderer", "torch"):
            raise ImportError(name + " is not for Blender")
sys.meta_path.insert(0, Ban())
sys.path.insert(0, folder)
import bpy
import vibe_render
from vibe_render.core.schema_import import schema
assert schema.__name__ == "vibe_render.schema", schema.__name__
assert schema.schema_hash() == digest
vibe_render.register()
bpy.context.scene.vibe.prompt = "misty"
assert bpy.context.scene.vibe.groups()
vibe_render.unregister()
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    return extension.build(tmp_path_factory.mktemp("extension"))


def test_zip_holds_the_schema_and_what_the_engine_runs_from(built):
    names = zipfile.ZipFile(built).namelist()
    assert {"blender_manifest.toml", "__init__.py", "schema/parameters.py", "engine.txt"} <= set(names)
    assert {"carried/requirements.txt", "carried/proxy_renderer/engine/worker.py"} <= set(names)
    assert {"looks/shipped/noir.json", "looks/shipped/noir.jpg"} <= set(names)


@pytest.fixture
def extracted(built, tmp_path):
    """The zip's two halves: what Blender runs, and what the engine's process runs."""
    zipfile.ZipFile(built).extractall(tmp_path / "vibe_render")
    (tmp_path / "vibe_render" / "carried").rename(tmp_path / "carried")
    return tmp_path


def strange(folder):
    addon = unreachable(folder, ["vibe_render"], ["vibe_render", "vibe_render.batch"])
    return addon | unreachable(folder / "carried", ["proxy_renderer"], ["proxy_renderer.engine.worker"])


def test_all_of_the_zip_can_be_reached_and_what_cannot_is_noticed(extracted):
    assert not strange(extracted)
    strays = {"vibe_render/scene/nobody.py", "proxy_renderer/cli/main.py", "proxy_renderer/guidance/judge.safetensors"}
    for name in strays:
        path = extracted / ("" if name.startswith("vibe") else "carried") / name
        path.parent.mkdir(exist_ok=True)
        path.write_text("import vibe_render\n")
    assert strange(extracted) == strays


def test_carried_engine_is_complete(built, tmp_path):
    """What the worker imports is in the zip; Blender is not among what pip would install."""
    zipfile.ZipFile(built).extractall(tmp_path)
    code = "import proxy_renderer as p, proxy_renderer.engine.worker, proxy_renderer.engine.session; print(p.__file__)"
    command = [sys.executable, "-c", code]
    environment = {"PYTHONPATH": str(tmp_path / "carried"), "HOME": str(tmp_path)}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert str(tmp_path) in done.stdout, done.stderr
    needed = (tmp_path / "carried" / "requirements.txt").read_text().splitlines()
    assert any(line.startswith("torch") for line in needed)
    assert not any(line.startswith("bpy") for line in needed)


def test_install_names_what_is_wrong(tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(VibeError, match="no `blender` on the PATH"):
        extension.install()
    with pytest.raises(VibeError, match="no Blender in"):
        extension.install(str(tmp_path))


@pytest.mark.slow
def test_install_asks_blender_and_passes_on_its_refusal(tmp_path):
    """A stand-in for Blender that writes down what it is asked, and then refuses."""
    program = tmp_path / "blender"
    program.write_text(f'#!/bin/sh\necho "$@" >> {tmp_path}/asked\n[ -e {tmp_path}/refuse ] && exit 1\nexit 0\n')
    program.chmod(0o755)
    assert "installed and enabled" in extension.install(str(tmp_path))
    asked = (tmp_path / "asked").read_text()
    assert asked.startswith("--command extension install-file -r user_default -e ")
    (tmp_path / "refuse").touch()
    with pytest.raises(VibeError, match="refused to install"):
        extension.install(str(program))


def test_works_alone(built, tmp_path):
    zipfile.ZipFile(built).extractall(tmp_path / "vibe_render")
    command = [sys.executable, "-c", ALONE, str(tmp_path), schema_hash()]
    done = subprocess.run(command, cwd=tmp_path, env={"HOME": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_check_can_fail(tmp_path):
    """Without the copied schema the same check does not pass."""
    extension._assemble(tmp_path / "vibe_render")
    shutil.rmtree(tmp_path / "vibe_render" / "schema")
    command = [sys.executable, "-c", ALONE, str(tmp_path), schema_hash()]
    done = subprocess.run(command, cwd=tmp_path, env={"HOME": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode != 0


def test_blender_refuses_a_bad_manifest(tmp_path):
    package = tmp_path / "vibe_render"
    extension._assemble(package)
    manifest = package / "blender_manifest.toml"
    manifest.write_text(manifest.read_text().replace('name = "Vibe Render"', 'name = ""'))
    with pytest.raises(VibeError, match="refused to validate"):
        extension._ask("validate", str(package))


def test_unwritable_folder_is_one_clear_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(VibeError, match="cannot be written"):
        extension.build(tmp_path / "file" / "out")
