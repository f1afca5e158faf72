# SPDX-License-Identifier: Apache-2.0
"""The parameters of a scene that is only described: its lights and materials are known, and Blender is not there."""

from __future__ import annotations

from collections.abc import Iterable

from ..schema import PARAMETERS, Instance

_LINKED = ("tint", "recolor", "rotation", "backdrop_color", "backdrop_tint", "backdrop_strength")


def plain_instances(
    lights: Iterable[tuple[str, str, str]], materials: Iterable[tuple[str, str]]
) -> dict[str, Instance]:
    """Every parameter at its default, nothing linked; lengths are in units of the scene's own.

    Args:
        lights: Name, type and role of each.

    Returns:
        The instances by key.
    """
    owners = {"light": [*lights], "material": [(name, "", role) for name, role in materials]}
    instances = [
        Instance(p, owner, (p.default,) * p.components, role=role)
        for p in PARAMETERS
        for owner, kind, role in owners.get(p.group, [("", "", "")])
        if p.name not in _LINKED and (not p.only or kind in p.only)
    ]
    return {i.key: i for i in instances}
