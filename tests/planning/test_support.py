# SPDX-License-Identifier: Apache-2.0
"""What no word names but pictures need."""

from dataclasses import replace

from plan_parts import CONTEXT, make_instances, make_plan, pictured

SPECULAR = "material/Body/specular"


def test_a_white_sky_all_around_does_not_bleach_vivid_things():
    open_air = replace(CONTEXT, world_share=1.0)
    assert make_plan("red, white background", context=open_air)[SPECULAR].lower[0] <= 0.2
    assert make_plan("red, white background")[SPECULAR].priority is None
    assert make_plan("grey, white background", context=open_air)[SPECULAR].priority is None
    assert make_plan("glossy red, white background", context=open_air)[SPECULAR].lower[0] >= 0.5


def test_a_pale_thing_before_a_named_ground_as_light_as_it_gets_darker():
    materials = make_instances()
    pale = replace(materials["material/Body/base_color"], value=(0.8, 0.8, 0.8))
    materials["material/Body/base_color"] = pale
    entry = make_plan("grey background", materials, pictured(48.0, (46.0, 0.0, 0.0)))[
        "material/Body/base_color"
    ]
    assert "stands out" in entry.reason
    assert entry.lower[0] < 0.6
