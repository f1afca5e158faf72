# SPDX-License-Identifier: Apache-2.0
"""`vibe explain`: what a prompt would do to a plain scene, without one."""

from __future__ import annotations

import json

from .language import compose, explain, parse, plan
from .language.explain import as_dict
from .language.types import PlanContext, SceneWords
from .schema import PARAMETERS, Instance

_OWNERS = {
    "light": (("Key", "AREA", "key"), ("Fill", "AREA", "fill"), ("Rim", "AREA", "rim")),
    "material": (("Subject", "", "subject"), ("Surroundings", "", "surroundings")),
}
_LINKED = ("tint", "recolor", "rotation")


def account(prompt: str, as_json: bool) -> str:
    """What the words mean, readable or as JSON, for a subject, its surroundings and three lights."""
    words = SceneWords(materials={"Subject": "subject", "Surroundings": "surroundings"})
    parsed = parse(prompt, words)
    prompts = compose(parsed)
    lights = {name: kind for name, kind, _ in _OWNERS["light"]}
    decided = plan(parsed, prompts, _plain_scene(), PlanContext(light_types=lights))
    if as_json:
        return json.dumps(as_dict(parsed, prompts, decided), indent=2, ensure_ascii=False)
    return explain(parsed, prompts, decided)


def _plain_scene() -> dict[str, Instance]:
    """Every parameter at its default; lengths are in units of the scene's own."""
    found = [
        Instance(p, owner, (p.default,) * p.components, role=role)
        for p in PARAMETERS
        for owner, kind, role in _OWNERS.get(p.group, (("", "", ""),))
        if p.name not in _LINKED and (not p.only or kind in p.only)
    ]
    return {i.key: i for i in found}
