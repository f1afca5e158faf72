# SPDX-License-Identifier: Apache-2.0
"""What plans reckon with: the light that falls on colors, what views can show, parts that are not the region."""

import pytest
import torch

from proxy_renderer.claims.wanted import claims_of
from proxy_renderer.color.blackbody import blackbody
from proxy_renderer.planning.advice import OfflineAdvisor
from proxy_renderer.planning.lights.facing import kelvin_color
from proxy_renderer.planning.planner import plan
from proxy_renderer.planning.types import PictureStats, PlanContext
from proxy_renderer.prompt.lexicon.user_words import default_vocabulary
from proxy_renderer.prompt.meaning import forget_parts, forget_sky
from proxy_renderer.prompt.parser import parse
from proxy_renderer.prompt.prompts import compose
from proxy_renderer.prompt.types import SceneWords
from proxy_renderer.prompt.understood import Understood
from proxy_renderer.schema import FAMILIES, Instance

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
    parsed = parse(prompt, SceneWords())
    return plan(parsed, compose(parsed), {i.key: i for i in instances}, context)


def test_white_surroundings_do_not_glow():
    """What glows shows no shadows: things would float on it."""
    picture = PictureStats({"surroundings": (60.0, 0.0, 0.0)})
    values = {"material/Wall/emission": (0.0,), "material/Wall/base_color": (0.85, 0.85, 0.85)}
    context = PlanContext(world_share=0.0, picture=picture, values=values)
    for name in ("emission", "emission_color"):
        assert make("white background", context)[f"material/Wall/{name}"].priority is None


def test_a_part_is_not_its_region():
    scene = SceneWords(
        "", {"Book": "subject", "Vase": "subject"}, {"Cover": "subject", "Clay": "subject"},
        {"Book": ("Cover",), "Vase": ("Clay",)},
    )  # fmt: skip
    parsed = parse("black book, metallic vase", scene)
    assert parsed.targets["subject_color"] == "black"
    forget_parts(parsed, {"Cover": 0.2, "Clay": 0.8}, default_vocabulary())
    assert parsed.colors == {}
    assert "subject_color" not in parsed.targets
    assert parsed.targets["subject_metal"] == "metal"


def test_a_sky_out_of_sight_is_its_light():
    parsed = parse("blue dusk, red sky, green walls", SceneWords())
    assert next(a.kind for a in parsed.attributes if a.color) == "sky"
    forget_sky(parsed, default_vocabulary())
    assert [a.kind for a in parsed.attributes if a.color] == ["ambience", "ambience", "surroundings"]
    tints = [claim for claim in claims_of(parsed, default_vocabulary()) if claim.measure == "tint"]
    assert {(claim.word, claim.part) for claim in tints} >= {("blue", "picture")}
    assert parsed.targets["surroundings_color"] == "green"


@pytest.mark.parametrize(("share", "kind"), [(0.0, "ambience"), (0.5, "sky"), (None, "sky")])
def test_whether_the_sky_is_seen_decides_what_its_color_is(share, kind):
    advice = OfflineAdvisor(Understood("blue dusk", SceneWords())).advise(
        None, {COLOR.key: COLOR}, PlanContext(world_share=share)
    )
    assert [a.kind for a in advice.parsed.attributes if a.color] == [kind]


@pytest.mark.parametrize("kelvin", [2100.0, 2700.0, 3500.0, 5000.0, 6500.0, 9000.0])
def test_warmth_is_about_blenders_blackbody(kelvin):
    theirs = blackbody(torch.tensor(kelvin))
    ours = torch.tensor(kelvin_color(kelvin))
    assert (ours - theirs / theirs.max()).abs().max() < 0.12


def test_what_small_parts_say_leaves_their_region_to_nobody_else():
    """Of small green grass under a sky that nobody sees the surroundings are neither green nor blue; "neon" is the picture's."""
    scene = SceneWords(
        "", {"Grass": "surroundings", "Cup": "subject"}, {"Grass": "surroundings", "Cup": "subject"},
        {"Grass": ("Grass",), "Cup": ("Cup",)},
    )  # fmt: skip
    vocabulary, shares = default_vocabulary(), {"Grass": 0.2, "Cup": 0.2}
    parsed = parse("green grass, blue sky", scene)
    forget_sky(parsed, vocabulary)
    forget_parts(parsed, shares, vocabulary)
    assert "surroundings_color" not in parsed.targets
    parsed = parse("neon cup", scene)
    forget_parts(parsed, shares, vocabulary)
    assert parsed.targets["saturation"] == "vivid"
