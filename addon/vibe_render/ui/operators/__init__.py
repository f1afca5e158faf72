# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators behind the buttons."""

from . import engine, exports, live, presets, result, running, vibe

MODULES = (engine, vibe, live, running, result, presets, exports)
