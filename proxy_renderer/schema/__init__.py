# SPDX-License-Identifier: Apache-2.0
"""The contract between Blender and the engine.

Standard library and relative imports only: building the extension copies this folder into it.
"""

from . import added_lights, budgets, labels, orbit, radiometry
from .budgets import BUDGETS, Budget
from .errors import VibeError
from .options.frames import frame_numbers
from .parameters import FAMILIES, GROUPS, PARAMETERS, REFERENCES, VERSION, schema_hash
from .spec import Instance, Parameter, Scale, Values, matches, split_key

__all__ = [
    "BUDGETS",
    "FAMILIES",
    "GROUPS",
    "PARAMETERS",
    "REFERENCES",
    "VERSION",
    "Budget",
    "Instance",
    "Parameter",
    "Scale",
    "Values",
    "VibeError",
    "added_lights",
    "budgets",
    "frame_numbers",
    "labels",
    "matches",
    "orbit",
    "radiometry",
    "schema_hash",
    "split_key",
]
