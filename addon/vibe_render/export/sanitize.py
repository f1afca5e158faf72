# SPDX-License-Identifier: GPL-3.0-or-later
"""Sanitizes an export: replaces values that are not finite, which scripts and drivers leave in scenes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..core.schema_import import labels, schema

_REASON = "it is not a number in Blender"


def finite_instances(read: Mapping[str, schema.Instance]) -> tuple[dict[str, schema.Instance], list[str]]:
    """The parameters, with default values (locked) for those that are not finite, and warnings that name them."""
    mended, warnings = {}, []
    for key, instance in read.items():
        if not all(map(math.isfinite, instance.value)):
            parameter = instance.parameter
            default = (parameter.default * instance.reference,) * parameter.components
            instance = replace(instance, value=default, locked=instance.locked or _REASON)
            warnings.append(
                f"{labels.title(key)} is not a number in Blender; the prediction takes {default[0]:g}."
            )
        mended[key] = instance
    return mended, warnings


def finite_content(value: Any, path: str, warnings: list[str]) -> Any:
    """A copy of nested dicts and lists in which numbers that are not finite are 0.

    Args:
        value: Dicts, lists, tuples (which become lists), numbers and texts.
        path: Where the value is in the job, its keys joined by "/"; "" for all of it.
        warnings: Gets a sentence for each number that was replaced.
    """
    if isinstance(value, Mapping):
        return {
            key: finite_content(item, f"{path}/{key}" if path else key, warnings)
            for key, item in value.items()
        }
    if isinstance(value, list | tuple):
        return [finite_content(item, path, warnings) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        warnings.append(
            f"{path.replace('/', ' › ').replace('_', ' ')} is not a number in Blender; the prediction takes 0."
        )
        return 0.0
    return value
