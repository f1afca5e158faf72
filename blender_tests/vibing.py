# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibes with the real engine, step by step, to break things meanwhile."""

import time

import bpy
import pytest
from vibe_render.run.state import addon_state

from proxy_renderer.schema import VibeError


def advance(until):
    """A new vibe, as far as a condition of it."""
    running = addon_state.begin(bpy.context)
    while not until(running):
        assert running.advance()
        time.sleep(0.02)
    return running


def fails(running):
    """What the panel says in the end."""
    try:
        while running.advance():
            time.sleep(0.02)
    except VibeError as error:
        addon_state.end(error)
        return str(error)
    pytest.fail("it did not fail")
