# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything in Blender's window, a module for each feature: its panel, its buttons and its fields."""
