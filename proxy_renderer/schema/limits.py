# SPDX-License-Identifier: Apache-2.0
"""Limits that more than one side keeps: the command line, the panel, the manifest, presets, the parser."""

from __future__ import annotations

LONGEST_PROMPT = 2000
"""Characters of a prompt."""

LONGEST_NAME = 60
"""Characters of a preset's name."""

LARGEST_SEED = 2**31 - 1
"""The largest whole number that a Blender property holds."""

MESH_FORMATS = (".obj", ".glb", ".gltf", ".ply", ".stl")
"""Suffixes of the bare meshes that can be opened."""
