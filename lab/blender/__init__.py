# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes for `python -m lab`, built by script; the command has them, the extension does not."""
