# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene in Blender: reads and writes its values, finds its subject, and adds what a look needs."""
