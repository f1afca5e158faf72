# SPDX-License-Identifier: Apache-2.0
"""The contract between Blender and the engine. Standard library and relative imports only:
building the extension copies this folder into it."""

from . import orbit
from .errors import VibeError
from .parameters import FAMILIES, GROUPS, PARAMETERS, REFERENCES, VERSION, schema_hash
from .spec import Instance, Parameter, Scale, Values, matches, split_key

__all__ = [
    "FAMILIES",
    "GROUPS",
    "PARAMETERS",
    "REFERENCES",
    "VERSION",
    "Instance",
    "Parameter",
    "Scale",
    "Values",
    "VibeError",
    "matches",
    "orbit",
    "schema_hash",
    "split_key",
]
