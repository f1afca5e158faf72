# SPDX-License-Identifier: Apache-2.0
"""The question of a round: the parameters that a model may plan, under short names, and the JSON schema of its answer."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..color.floats import decode, encode, hex_from_srgb, srgb_from_lab
from ..planning.advice import Advice
from ..planning.types import Plan
from ..schema import FAMILIES, Instance, Values
from ..schema.parameters import SRGB
from ..words.lexicon.quantities import quantities
from ..words.types import SceneDescription
from .client import Question
from .transport import clean

_LIGHTS, _MATERIALS = 8, 10  # the most important ones; a question has to fit into small contexts


class AliasTable:
    """The parameters that a model may plan, by short names."""

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
        self.scene: list[
            dict[str, Any]
        ] = []  # lights and materials that have a row, as a model is told of them
        ids: dict[tuple[str, str], str] = {}
        for group, chosen in (("material", materials[:_MATERIALS]), ("light", lights[:_LIGHTS])):
            for number, (owner, role) in enumerate(chosen, 1):
                ids[group, owner] = f"{group}{number}"
                row: dict[str, Any] = {"id": ids[group, owner], "name": clean(owner, 60), "role": role}
                if group == "material" and owner in share:
                    row["part_of_region"] = round(share[owner], 2)
                elif group == "light" and (kind := context.light(owner).type):
                    row["type"] = kind
                self.scene.append(row)
        self.rows: dict[str, Instance] = {}  # name in questions and answers -> instance
        for instance in free:
            group, owner = instance.parameter.group, instance.owner
            head = ids.get((group, owner)) if owner else group
            if head:
                self.rows[f"{head}/{instance.parameter.name}"] = instance

    def shown(self, instance: Instance, values: Values) -> Values:
        """Values as a model sees them: colors as sRGB, light directions relative to the camera, -180 up to 180 degrees."""
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
        """A model's range with its ends in order; directions may pass 180 degrees: 150 to -150 becomes 150 to 210."""
        if _is_direction(instance) and lower[0] - upper[0] > 180.0:
            return lower, (upper[0] + 360.0,)
        return tuple(map(min, lower, upper)), tuple(map(max, lower, upper))

    def in_schema_units(self, instance: Instance, lower: Values, upper: Values) -> tuple[Values, Values]:
        """The schema's values for a range in the units of `shown`: its inverse."""
        if instance.parameter.kind == "color" and instance.parameter.scale == SRGB:
            lower, upper = (tuple(decode(max(v, 0.0)) for v in end) for end in (lower, upper))
        if _is_direction(instance):
            middle = (lower[0] + upper[0]) / 2 + self._camera
            turn = 360.0 * round((instance.value[0] - middle) / 360.0) + self._camera
            return (lower[0] + turn,), (upper[0] + turn,)
        return lower, upper


def _is_direction(instance: Instance) -> bool:
    return instance.parameter.family == "light/azimuth"


REGIONS = ("subject", "surroundings")
CAPTIONS = (*REGIONS, "whole")
_DIGITS = 4

SYSTEM = Path(__file__).with_name("system.txt").read_text("utf-8").strip()


def make_question(
    look: str, table: AliasTable, context: SceneDescription, draft: Advice, picture: bytes | None
) -> Question:
    """The question of a round, with the offline planner's draft for the model to improve on."""
    document = {
        "look": look,
        "scene": table.scene,
        "measured": _measured(context),
        "draft": {
            "captions": {name: getattr(draft.prompts, name) for name in CAPTIONS},
            "targets": draft.goals.classes,
            "not_understood": draft.goals.parsed.ignored,
        },
        "what_parameters_do": _docs(table),
        "parameters": {name: _row(name, table, context, draft.plan) for name in table.rows},
    }
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
    return Question(SYSTEM, text, picture, answer_schema(table))


def answer_schema(table: AliasTable) -> dict[str, Any]:
    """The JSON schema of an answer; only what strict modes of all servers have: no bounds, no patterns."""
    names = list(table.rows)
    text = {"type": "string"}
    texts = {"type": "array", "items": text}
    key = {"type": "string", "enum": names}
    numbers = {"type": "array", "items": {"type": "number"}}
    captions = dict.fromkeys(CAPTIONS, text)
    targets = {
        name: {"type": "string", "enum": [*quantity.classes, ""]}
        for name, quantity in quantities().by_name.items()
        if quantity.classes
    }
    number = {"type": "integer"}
    entry = json_object(parameter=key, lower=numbers, upper=numbers, priority=number, reason=text)
    return json_object(
        prompts=json_object(**captions, **{f"{name}_negatives": texts for name in captions}),
        targets=json_object(**targets),
        colors=json_object(**dict.fromkeys(REGIONS, text)),
        ignored=texts,
        plan={"type": "array", "items": entry},
        keep={"type": "array", "items": key},
    )


def json_object(**properties: Any) -> dict[str, Any]:
    """The JSON schema of an object with these properties, all of them required, and no others."""
    return {
        "type": "object",
        "properties": properties,
        "required": list(properties),
        "additionalProperties": False,
    }


def _docs(table: AliasTable) -> dict[str, str]:
    """Family -> what it does, from the parameter table."""
    docs = {}
    for family in dict.fromkeys(i.parameter.family for i in table.rows.values()):
        p = FAMILIES[family]
        unit = "sRGB" if p.kind == "color" and p.scale == SRGB else p.unit
        docs[family] = p.doc + (f" [{unit}]" if unit else "")
        if family == "light/azimuth":
            docs[family] = (
                "Where the light comes from, seen from the subject, relative to the camera: 0 is from the camera, "
                "-90 from the picture's left, 90 from its right, 180 from behind. [deg]"
            )
    return docs


def _row(name: str, table: AliasTable, context: SceneDescription, plan: Plan) -> dict[str, Any]:
    instance = table.rows[name]
    now = table.shown(instance, context.values.get(instance.key, instance.value))
    low, high = table.bounds(instance)
    row: dict[str, Any] = {"now": [_number(v) for v in now], "min": _number(low), "max": _number(high)}
    entry = plan.get(instance.key)
    if entry is not None and entry.priority is not None:
        ends = [[_number(v) for v in table.shown(instance, end)] for end in (entry.lower, entry.upper)]
        row["draft"] = {"range": ends, "priority": entry.priority, "why": clean(entry.reason, 120)}
    return row


def _measured(context: SceneDescription) -> dict[str, Any]:
    """Measures of the current picture, for models that see badly or not at all."""
    if context.picture is None:
        return {}
    colors = context.picture.lab.items()
    figures: dict[str, Any] = {f"{r}_mean_color": hex_from_srgb(srgb_from_lab(lab)) for r, lab in colors}
    if percentiles := context.picture.percentiles:
        names = ("darkest_5_percent", "median", "brightest_5_percent")
        figures |= {f"lightness_{n}": round(v) for n, v in zip(names, percentiles, strict=True)}
    return figures


def _number(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
