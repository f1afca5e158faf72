# SPDX-License-Identifier: Apache-2.0
"""The contract between Blender and the engine.

Standard library and relative imports only, because the build copies this folder into the extension.
"""

from . import added_lights, labels, light_links, limits, material_copies, orbit, radiometry
from .errors import VibeError
from .limits import BUDGETS, Budget
from .options.checks import frame_numbers
from .parameters import (
    FAMILIES,
    GROUPS,
    PARAMETERS,
    REFERENCES,
    VERSION,
    Instance,
    Parameter,
    Scale,
    Values,
    matches,
    schema_hash,
    split_key,
)

__all__ = [
    "BUDGETS", "FAMILIES", "GROUPS", "PARAMETERS", "REFERENCES", "VERSION", "Budget", "Instance",
    "Parameter", "Scale", "Values", "VibeError", "added_lights", "frame_numbers", "labels", "light_links",
    "limits", "matches", "material_copies", "orbit", "radiometry", "schema_hash", "split_key",
]  # fmt: skip
