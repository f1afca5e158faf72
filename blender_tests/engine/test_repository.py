# SPDX-License-Identifier: GPL-3.0-or-later
"""The repository that Blender's preferences subscribe to: a real Blender installs from it, updates and uninstalls.

The server is on the loopback address, in this process, and ends with the test.
"""

import functools
import http.server
import json
import os
import subprocess
import sys
import threading

import pytest

from proxy_renderer.blender import extension

OLD, NEW = "0.0.1", "99.0.0"

# An artist's Blender, from one version to the next. It prints what is there at each stage.
ARTIST = """
import json, os, shutil, sys
from pathlib import Path
import bpy

url, newer, subscribed = sys.argv[1:]
bpy.context.preferences.system.use_online_access = True
repositories = bpy.context.preferences.extensions.repos
repository = repositories.new(name="Vibe", module="vibe", remote_url=url)
repository.use_remote_url = True
place, name = list(repositories).index(repository), "bl_ext.vibe.vibe_render"

def look(stage):
    addon = bpy.context.preferences.addons.get(name)
    manifest = Path(bpy.utils.user_resource("EXTENSIONS"), "vibe", "vibe_render", "blender_manifest.toml")
    print("SEEN", json.dumps({
        "stage": stage,
        "version": manifest.read_text().split('version = "')[2].split('"')[0] if manifest.is_file() else "",
        "model": addon.preferences.vlm_model if addon else "",
        "presets": [p.name for p in presets.glob("*.json")],
        "engine": engine.is_dir(),
    }))

bpy.ops.extensions.repo_sync(repo_index=place)
bpy.ops.extensions.package_install(repo_index=place, pkg_id="vibe_render", enable_on_install=True)
from bl_ext.vibe.vibe_render.looks import library
from bl_ext.vibe.vibe_render.ui.engine_state import setup_folder
presets, engine = library.preset_folder(), setup_folder()
presets.mkdir(parents=True, exist_ok=True)
shutil.copy(library.SHIPPED / "noir.json", presets / "mine.json")
engine.mkdir(parents=True)
bpy.context.preferences.addons[name].preferences.vlm_model = "a-model"
look("installed")
shutil.copytree(newer, subscribed, dirs_exist_ok=True)
bpy.ops.extensions.repo_sync(repo_index=place)
bpy.ops.extensions.package_upgrade_all()
look("updated")
bpy.ops.vibe.remove_engine()
look("engine removed")
engine.mkdir(parents=True)
bpy.ops.extensions.package_uninstall(repo_index=place, pkg_id="vibe_render")
look("uninstalled")
sys.stdout.flush()
os._exit(0)  # Blender 4.5 as a module may hang at its end
"""


def published(out, version, monkeypatch):
    """A repository with this version of the extension."""
    assemble = extension._assemble

    def assembled(package):
        assemble(package)
        manifest = package / "blender_manifest.toml"
        lines = manifest.read_text().splitlines()
        lines = [f'version = "{version}"' if line.startswith("version = ") else line for line in lines]
        manifest.write_text("\n".join(lines))

    with monkeypatch.context() as patch:
        patch.setattr(extension, "_assemble", assembled)
        return extension.repository(out)


@pytest.fixture
def served(tmp_path):
    """A folder, and the address where it is served."""
    folder = tmp_path / "subscribed"
    folder.mkdir()
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=folder)
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield folder, f"http://127.0.0.1:{server.server_port}/index.json"
        server.shutdown()


def test_a_folder_has_one_version_only(tmp_path, monkeypatch):
    """Of two, Blender would install the first, and never update."""
    for version in (OLD, NEW):
        index = json.loads(published(tmp_path, version, monkeypatch).read_text())
        assert [(row["id"], row["version"]) for row in index["data"]] == [("vibe_render", version)]


@pytest.mark.slow
def test_a_blender_installs_updates_and_uninstalls(served, tmp_path, monkeypatch):
    """Settings and presets survive an update, presets also the end; the engine goes on request, and at the end."""
    folder, url = served
    published(folder, OLD, monkeypatch)
    published(tmp_path / "newer", NEW, monkeypatch)
    kept = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    environment = kept | {"HOME": str(tmp_path), "BLENDER_USER_RESOURCES": str(tmp_path / "user")}
    command = [sys.executable, "-c", ARTIST, url, str(tmp_path / "newer"), str(folder)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300)
    seen = [json.loads(line[5:]) for line in done.stdout.splitlines() if line.startswith("SEEN ")]
    assert len(seen) == 4, done.stdout[-2000:] + done.stderr[-2000:]
    own = {"model": "a-model", "presets": ["mine.json"]}
    assert seen == [
        {"stage": "installed", "version": OLD, "engine": True, **own},
        {"stage": "updated", "version": NEW, "engine": True, **own},
        {"stage": "engine removed", "version": NEW, "engine": False, **own},
        {"stage": "uninstalled", "version": "", "engine": False, "model": "", "presets": ["mine.json"]},
    ]
