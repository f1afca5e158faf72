# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine's process: find it, set it up, exchange messages with it. No bpy in here."""
