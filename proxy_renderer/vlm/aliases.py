# SPDX-License-Identifier: Apache-2.0
"""The parameters that a model may plan, under short names of ours, with values that it can judge.

Names of lights and materials are the artist's, and may hold anything, instructions included. So a
model speaks of "material1/roughness"; the names are told once, as data.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..color.floats import decode, encode
from ..prompt.types import SceneDescription
from ..schema import Instance, Values
from ..schema.spec import SRGB

_LIGHTS, _MATERIALS = 8, 10  # the most important ones; a question has to fit into small contexts
_LONGEST_NAME = 60


@dataclass(frozen=True)
class Alias:
    """A short name for a light or material, which a model may use.

    Attributes:
        id: "light1".
        name: The artist's.
        role: As in `schema.Instance`.
        share: Fraction of its region's pixels, for materials; None if unknown.
        kind: Type of light; "" for materials.
    """

    id: str
    name: str
    role: str
    share: float | None = None
    kind: str = ""


class AliasTable:
    """The parameters that a model may plan, by short names.

    Args:
        instances: All of the scene's, by key; locked ones are left out.
        context: What the planner knows about the scene.

    Attributes:
        rows: Name in questions and answers -> instance.
        aliases: Lights and materials that have a row.
        names: Key -> name in questions, the inverse of `rows`.
    """

    def __init__(self, instances: Mapping[str, Instance], context: SceneDescription) -> None:
        self._camera = context.camera_azimuth
        free = [i for i in instances.values() if not i.locked]
        owners = {
            group: list(dict.fromkeys((i.owner, i.role) for i in free if i.parameter.group == group))
            for group in ("material", "light")
        }
        share = context.material_share
        materials = sorted(owners["material"], key=lambda o: (o[1] != "subject", -share.get(o[0], 0.0), o))
        lights = sorted(owners["light"], key=lambda o: (o[1] != "key", o))
        self.aliases = [
            Alias(f"material{n}", _name(owner), role, share.get(owner))
            for n, (owner, role) in enumerate(materials[:_MATERIALS], 1)
        ]
        self.aliases += [
            Alias(f"light{n}", _name(owner), role, kind=context.light(owner).type)
            for n, (owner, role) in enumerate(lights[:_LIGHTS], 1)
        ]
        chosen = [*materials[:_MATERIALS], *lights[:_LIGHTS]]
        groups = ["material"] * len(materials[:_MATERIALS]) + ["light"] * len(lights[:_LIGHTS])
        ids = {
            (group, owner): alias.id
            for group, (owner, _), alias in zip(groups, chosen, self.aliases, strict=True)
        }
        self.rows: dict[str, Instance] = {}
        for instance in free:
            group, owner = instance.parameter.group, instance.owner
            head = ids.get((group, owner)) if owner else group
            if head:
                self.rows[f"{head}/{instance.parameter.name}"] = instance
        self.names = {i.key: name for name, i in self.rows.items()}

    def shown(self, instance: Instance, values: Values) -> Values:
        """Values as a model sees them: colors as sRGB, light directions relative to the camera.

        Args:
            instance: The parameter.
            values: In the schema's units; colors are linear.

        Returns:
            As many numbers; sRGB-encoded colors, directions in degrees from -180 up to 180.
        """
        if instance.parameter.kind == "color" and instance.parameter.scale == SRGB:
            return tuple(encode(max(v, 0.0)) for v in values)
        if _is_direction(instance):
            return ((values[0] - self._camera + 180.0) % 360.0 - 180.0,)
        return values

    def bounds(self, instance: Instance) -> tuple[float, float]:
        """Least and greatest value of a component, as shown."""
        if _is_direction(instance):
            return -180.0, 180.0
        low, high = self.shown(instance, instance.lower), self.shown(instance, instance.upper)
        return min(low), max(high)

    def ordered(self, instance: Instance, lower: Values, upper: Values) -> tuple[Values, Values]:
        """A model's range with its ends in order.

        A direction's range may pass 180 degrees: from 150 to -150 becomes 150 to 210.

        Args:
            instance: The parameter.
            lower: One end, in the units of `shown`.

        Returns:
            The lower and the upper end, in the units of `shown`.
        """
        if _is_direction(instance) and lower[0] - upper[0] > 180.0:
            return lower, (upper[0] + 360.0,)
        return tuple(map(min, lower, upper)), tuple(map(max, lower, upper))

    def meant(self, instance: Instance, lower: Values, upper: Values) -> tuple[Values, Values]:
        """The schema's values for a range in the units of `shown`: its inverse.

        Args:
            instance: The parameter.
            lower: The lower end, as `ordered` returns it.

        Returns:
            Both ends in the schema's units; a direction's are turned by whole circles, nearest to the artist's value.
        """
        if instance.parameter.kind == "color" and instance.parameter.scale == SRGB:
            return _linear(lower), _linear(upper)
        if _is_direction(instance):
            middle = (lower[0] + upper[0]) / 2 + self._camera
            turn = 360.0 * round((instance.value[0] - middle) / 360.0) + self._camera
            return (lower[0] + turn,), (upper[0] + turn,)
        return lower, upper


def _is_direction(instance: Instance) -> bool:
    return instance.parameter.family == "light/azimuth"


def _linear(srgb: Values) -> Values:
    return tuple(decode(max(v, 0.0)) for v in srgb)


def _name(text: str) -> str:
    return text[:_LONGEST_NAME]
