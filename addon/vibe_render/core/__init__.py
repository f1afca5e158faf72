# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that the add-on's other packages share: journal of changes, files, versions of Blender, the schema."""

ADDON = __package__.rpartition(".")[0]  # the add-on's package name; Blender stores its preferences under it
