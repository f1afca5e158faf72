# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the tests that need Blender: bpy in this process, an empty file for each test."""

import contextlib
import os
import sys

import bpy
import pytest
import vibe_render
from small_scenes import studio
from vibe_render.run.state import addon_state
from vibe_render.ui import drawing

with contextlib.suppress(ImportError):
    # Torch would load it later. After a render with a compositor, for which Mesa loads an LLVM of its own, that crashes.
    import triton  # noqa: F401


@pytest.fixture
def scene():
    """An empty scene in a fresh file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


@pytest.fixture(scope="module")
def registered():
    """The add-on, registered for all tests of a file, as in one session of Blender: its engine stays warm."""
    vibe_render.register()
    yield
    vibe_render.unregister()


@pytest.fixture
def addon(registered, scene):
    """A studio whose vibe lasts for as long as a test wants, in an empty file; nothing under way from another test."""
    studio(scene)
    settings = scene.vibe
    settings.prompt, settings.effort, settings.anchor = "glossy red cube, warm light", "CUSTOM", False
    settings.rounds, settings.steps, settings.size = 100, 1000, 64
    yield scene
    drawing.end_timers()
    addon_state.cancel()
    addon_state.end_live()
    addon_state.readings.forget()


def pytest_collection_modifyitems(items):
    """Files with slow tests begin: started last, the longest would run on alone, beside an idle worker."""
    slow = {item.path for item in items if "slow" in item.keywords}
    items.sort(key=lambda item: (not item.path.name.startswith("test_window"), item.path not in slow))


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
