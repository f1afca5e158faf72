# SPDX-License-Identifier: Apache-2.0
"""What does not glow is not made to: files of Blender before 4 have an emission strength of 1 and a black emission color."""

import pytest

from proxy_renderer.planning.planner import plan
from proxy_renderer.prompt.parser import parse
from proxy_renderer.prompt.prompts import compose
from proxy_renderer.prompt.types import PlanContext, SceneWords
from proxy_renderer.schema import FAMILIES, Instance

COLOR = "material/Body/emission_color"


def entry(prompt, emission_color, strength):
    values = {"base_color": (0.5,) * 3, "emission_color": emission_color, "emission": (strength,)}
    rows = [Instance(FAMILIES[f"material/{n}"], "Body", v, 1.0, "subject") for n, v in values.items()]
    instances = {row.key: row for row in rows}
    scene = SceneWords(objects={"Body": "subject"}, materials={"Body": "subject"})
    parsed = parse(prompt, scene)
    return plan(parsed, compose(parsed), instances, PlanContext())[COLOR]


@pytest.mark.parametrize(
    ("prompt", "emission_color", "strength", "changes"),
    [
        ("navy blue", (0.0, 0.0, 0.0), 1.0, False),
        ("navy blue", (1.0, 1.0, 1.0), 0.0, False),
        ("navy blue", (1.0, 0.4, 0.1), 1.0, True),
        ("glowing blue", (0.0, 0.0, 0.0), 1.0, True),
    ],
)
def test_a_color_reaches_the_emission_of_what_glows(prompt, emission_color, strength, changes):
    found = entry(prompt, emission_color, strength)
    assert (found.priority is not None) == changes, found.reason
