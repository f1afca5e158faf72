# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the tests that need Blender: bpy in this process, an empty file for each test."""

import os
import sys

import bpy
import pytest

os.environ.pop("VIBE_VLM_MODEL", None)  # no test asks the model that its reader may have configured


@pytest.fixture
def scene():
    """An empty scene in a fresh file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene


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
