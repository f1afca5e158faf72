# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators behind the buttons."""

from . import engine, exports, presets, result, running, vibe

MODULES = (engine, vibe, running, result, presets, exports)
