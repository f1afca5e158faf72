# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe from start to end: its state, what is said of it, its result."""
