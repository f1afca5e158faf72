# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Render without a window: commands, shots, reports."""
