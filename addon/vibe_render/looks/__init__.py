# SPDX-License-Identifier: GPL-3.0-or-later
"""Saved looks: presets, the library, assets for the Asset Browser, LUTs."""
