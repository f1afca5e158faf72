# SPDX-License-Identifier: GPL-3.0-or-later
"""Vibe Render without a window: command line, commands, shots, reports. `batch.py` is its entry point."""
