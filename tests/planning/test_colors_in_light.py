# SPDX-License-Identifier: Apache-2.0
"""What plans reckon with: the light that falls on colors, what views can show, parts that are not the region."""

import pytest
import torch

from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.color.tensors import blackbody
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.planning.light_levels import kelvin_color
from proxy_renderer.planning.planner import plan
from proxy_renderer.schema import FAMILIES, Instance
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import Understood, parse
from proxy_renderer.words.types import PictureStats, SceneDescription

COLOR = Instance(FAMILIES["material/base_color"], "Body", (0.5, 0.5, 0.5), 1.0, "subject")


def make(prompt, context):
    families = {n: FAMILIES[f"material/{n}"] for n in ("base_color", "emission", "emission_color")}
    instances = [
        Instance(
            family,
            owner,
            (0.5,) * family.components if n == "base_color" else (family.default,) * family.components,
            1.0,
            role,
        )
        for owner, role in (("Body", "subject"), ("Wall", "surroundings"))
        for n, family in families.items()
    ]
    parsed = parse(prompt, SceneDescription())
    return plan(goals_of(parsed), {i.key: i for i in instances}, context)


def test_white_surroundings_do_not_glow():
    """What glows shows no shadows: things would float on it."""
    picture = PictureStats({"surroundings": (60.0, 0.0, 0.0)})
    values = {"material/Wall/emission": (0.0,), "material/Wall/base_color": (0.85, 0.85, 0.85)}
    context = SceneDescription(world_share=0.0, picture=picture, values=values)
    for name in ("emission", "emission_color"):
        assert make("white background", context)[f"material/Wall/{name}"].priority is None


def test_a_sky_out_of_sight_is_its_light():
    parsed = parse("blue dusk, red sky, green walls", SceneDescription(sky=False))
    assert [a.kind for a in parsed.attributes if a.color] == ["ambience", "ambience", "surroundings"]
    tints = [claim for claim in claims_of(goals_of(parsed), default_vocabulary()) if claim.measure == "tint"]
    assert {(claim.word, claim.part) for claim in tints} >= {("blue", "picture")}


@pytest.mark.parametrize(("sky", "kind"), [(False, "ambience"), (True, "sky")])
def test_whether_the_sky_is_seen_decides_what_its_color_is(sky, kind):
    parsed = Understood("blue dusk", SceneDescription(sky=sky)).parsed
    assert [a.kind for a in parsed.attributes if a.color] == [kind]


@pytest.mark.parametrize("kelvin", [2100.0, 2700.0, 3500.0, 5000.0, 6500.0, 9000.0])
def test_warmth_is_about_blenders_blackbody(kelvin):
    theirs = blackbody(torch.tensor(kelvin))
    ours = torch.tensor(kelvin_color(kelvin))
    assert (ours - theirs / theirs.max()).abs().max() < 0.12
