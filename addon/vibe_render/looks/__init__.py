# SPDX-License-Identifier: GPL-3.0-or-later
"""Looks that are kept: presets, the library, assets for the Asset Browser, LUTs."""
