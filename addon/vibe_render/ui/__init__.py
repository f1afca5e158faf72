# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels, operators, properties and preferences in Blender."""
