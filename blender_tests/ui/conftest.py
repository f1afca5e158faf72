# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on in an empty file."""

import pytest
import vibe_render


@pytest.fixture
def addon(scene):
    """The add-on, registered with an empty file."""
    vibe_render.register()
    yield scene
    vibe_render.unregister()
