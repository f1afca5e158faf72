# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on in an empty file, and ways through the panel in a real window."""

import functools
import os
from pathlib import Path

import pytest
import vibe_render
from window_walk import bundle_packages, walk_way, window_root


@pytest.fixture
def addon(scene):
    """The add-on, registered with an empty file."""
    vibe_render.register()
    yield scene
    vibe_render.unregister()


@pytest.fixture(scope="session")
def walk(tmp_path_factory):
    """Walks a way, once each; what was seen on it."""
    root = window_root()
    user = tmp_path_factory.mktemp("user")
    bundle_packages(root, user / "scripts" / "addons" / "modules")
    kept = os.environ.get("VIBE_WINDOW_OUT")

    @functools.cache
    def walked(way):
        out = Path(kept) / way if kept else tmp_path_factory.mktemp(way)
        out.mkdir(parents=True, exist_ok=True)
        return walk_way(way, out, user)

    return walked
