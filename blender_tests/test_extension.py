# SPDX-License-Identifier: GPL-3.0-or-later
"""The extension's zip: built and validated by Blender's tool, and working without the engine's code."""

import subprocess
import sys
import zipfile

import pytest

from proxy_renderer import extension
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
from vibe_render.contract import schema
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


def test_zip_holds_the_schema_and_no_engine(built):
    names = zipfile.ZipFile(built).namelist()
    assert {"blender_manifest.toml", "__init__.py", "schema/parameters.py", "engine.txt"} <= set(names)
    assert not [n for n in names if "__pycache__" in n or "worker" in n or "test" in n or "bench" in n]


def test_works_alone(built, tmp_path):
    zipfile.ZipFile(built).extractall(tmp_path / "vibe_render")
    command = [sys.executable, "-c", ALONE, str(tmp_path), schema_hash()]
    done = subprocess.run(command, cwd=tmp_path, env={"HOME": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def test_the_check_can_fail(tmp_path):
    """Without the copied schema the same check does not pass."""
    extension._assemble(tmp_path / "vibe_render")
    for file in (tmp_path / "vibe_render" / "schema").iterdir():
        file.unlink()
    command = [sys.executable, "-c", ALONE, str(tmp_path), schema_hash()]
    done = subprocess.run(command, cwd=tmp_path, env={"HOME": str(tmp_path)}, capture_output=True, text=True)
    assert done.returncode != 0


def test_blender_refuses_a_bad_manifest(tmp_path):
    package = tmp_path / "vibe_render"
    extension._assemble(package)
    manifest = package / "blender_manifest.toml"
    manifest.write_text(manifest.read_text().replace('name = "Vibe Render"', 'name = ""'))
    with pytest.raises(VibeError, match="refused to validate"):
        extension._ask(extension._blender_tool(), "validate", str(package))


def test_unwritable_folder_is_one_clear_line(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(VibeError, match="Cannot write"):
        extension.build(tmp_path / "file" / "out")
