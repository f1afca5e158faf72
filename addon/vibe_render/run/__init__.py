# SPDX-License-Identifier: GPL-3.0-or-later
"""A vibe (one run of the search) from start to end: its driver, the add-on's state, its result in the scene."""
