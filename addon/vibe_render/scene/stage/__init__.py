# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes built by script: a neutral stage for a bare mesh, and the scene of `vibe demo`."""
