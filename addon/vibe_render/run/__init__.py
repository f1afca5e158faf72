# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe from start to end: its session, its status, its result in the scene."""
