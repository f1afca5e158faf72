# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that every room needs and no room owns: the journal, files, versions of Blender, the schema."""

ADDON = __package__.rpartition(".")[0]  # the add-on's own name, by which Blender keeps its preferences
