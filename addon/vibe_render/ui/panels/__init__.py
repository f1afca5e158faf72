# SPDX-License-Identifier: GPL-3.0-or-later
"""The panels."""

from . import main, presets

MODULES = (main, presets)
