# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators behind the buttons."""

from . import engine, exports, live, presets, result, running, vibe, words

MODULES = (engine, vibe, live, words, running, result, presets, exports)
