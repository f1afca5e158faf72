# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists see and press in Blender."""
