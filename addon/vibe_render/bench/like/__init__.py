# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's side of `vibe bench like`: looks that are drawn at random and hidden."""
