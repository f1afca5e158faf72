# SPDX-License-Identifier: GPL-3.0-or-later
"""What the buttons do."""

from . import engine, exports, presets, result, running, vibe

MODULES = (engine, vibe, running, result, presets, exports)
