# SPDX-License-Identifier: Apache-2.0
"""Lights: the types of Blender, the world and its suns, glowing surfaces, and their shadows."""
