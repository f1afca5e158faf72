# SPDX-License-Identifier: GPL-3.0-or-later
"""Scenes for `vibe bench`, built by script; the command has them, the extension does not."""
