# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe from start to end: its driver, for the panel and for runs without a window; its status, its result in the scene."""
