# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the tests that need Blender: bpy in this process, an empty file for each test."""

import bpy
import pytest


@pytest.fixture
def scene():
    """An empty scene in a fresh file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    return bpy.context.scene
