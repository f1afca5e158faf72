# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine's process: found, set up, talked to. No bpy in here."""
