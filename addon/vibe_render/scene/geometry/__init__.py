# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangles of what a render shows, and what the camera sees of them."""
