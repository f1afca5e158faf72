# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the tests that need Blender: bpy in this process, an empty file for each test."""

import os
import sys

import bpy
import pytest
import vibe_render
from small_scenes import studio


@pytest.fixture
def scene():
    """An empty scene in a fresh file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


@pytest.fixture
def addon(scene):
    """The add-on, registered, with a studio whose vibe lasts for as long as a test wants."""
    vibe_render.register()
    studio(scene)
    settings = scene.vibe
    settings.prompt, settings.budget, settings.anchor = "glossy red cube, warm light", "CUSTOM", False
    settings.rounds, settings.steps, settings.size = 100, 1000, 64
    yield scene
    vibe_render.unregister()


_status = pytest.StashKey[int]()


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session, exitstatus):
    """Remembers how the tests went."""
    session.config.stash[_status] = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure(config):
    """Leaves before Blender 4.5's own exit handlers, which may wait for ever on a thread of theirs."""
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(config.stash.get(_status, 1))
