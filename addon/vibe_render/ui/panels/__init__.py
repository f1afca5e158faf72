# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels draw."""

from . import main, presets

MODULES = (main, presets)
