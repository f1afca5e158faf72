# SPDX-License-Identifier: Apache-2.0
"""Limits that command line, panel, manifest, presets and parser share, and budgets: how much work a vibe may do."""

from dataclasses import dataclass

LONGEST_PROMPT = 2000  # characters of a prompt
LONGEST_NAME = 60  # characters of a preset's name
LARGEST_SEED = 2**31 - 1  # the largest whole number that a Blender property holds
MESH_FORMATS = (".obj", ".glb", ".gltf", ".ply", ".stl")  # suffixes of the bare meshes that can be opened


@dataclass(frozen=True)
class Budget:
    """How much work a vibe may do."""

    rounds: int  # outer rounds of Algorithm 1
    steps: int  # most steps of the inner loop in each round
    size: int  # longer side of the images, pixels
    starts: int  # starting points that a coarse first pass tries; 1 for the artist's scene alone
    summary: str  # for whom it is, in words


BUDGETS = {
    "quick": Budget(3, 8, 256, 1, "a first idea"),
    "standard": Budget(6, 12, 512, 1, "the usual"),
    "thorough": Budget(10, 20, 512, 6, "several starts, and time to refine"),
}
STANDARD = BUDGETS["standard"]
NUMBERS = ("rounds", "steps", "size", "starts")  # options that the effort decides if they are not given
