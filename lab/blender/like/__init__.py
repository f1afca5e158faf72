# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `python -m lab like`: looks that are drawn at random and hidden."""
