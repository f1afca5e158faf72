# SPDX-License-Identifier: GPL-3.0-or-later
"""The operators behind the buttons."""

from . import engine, exports, live, picture, presets, result, running, vibe, words

MODULES = (engine, vibe, live, words, picture, running, result, presets, exports)
