# SPDX-License-Identifier: Apache-2.0
"""Ranges around shades of the artist's color: fading pales and grays it, and keeps its hue."""

import pytest

from proxy_renderer.color.floats import chroma, lab_from_srgb, srgb_from_linear
from proxy_renderer.planning.ranges import effect_range
from proxy_renderer.planning.sources import Sources
from proxy_renderer.planning.types import PlanContext
from proxy_renderer.prompt.lexicon.entries import parse_effect
from proxy_renderer.prompt.types import Attribute
from proxy_renderer.schema import FAMILIES, Instance

RED = (0.4, 0.02, 0.03)


def shown(effect, color=RED, strength=1.0):
    """Lab of the middle of a range."""
    instance = Instance(FAMILIES["material/base_color"], "Jacket", color, 1.0, "subject")
    attribute = Attribute("faded", "faded surface", "color", "subject", strength=strength)
    low, high = effect_range(parse_effect(effect), attribute, instance, Sources(PlanContext()))
    return lab_from_srgb(srgb_from_linear(tuple((a + b) / 2 for a, b in zip(low, high, strict=True))))


OWN = lab_from_srgb(srgb_from_linear(RED))
FADED = "material/base_color shade 0.12,0.35..0.35,0.7"


def test_fading_makes_paler_and_grayer():
    faded = shown(FADED)
    assert faded[0] > OWN[0] + 5
    assert chroma(faded) < 0.85 * chroma(OWN)
    assert faded[1] > 10  # still red


def test_below_zero_is_darker():
    assert shown("material/base_color shade -0.35,1..-0.12,1.2")[0] < OWN[0] - 5


def test_slightly_changes_less():
    assert OWN[0] < shown(FADED, strength=0.5)[0] < shown(FADED)[0]


@pytest.mark.parametrize("chromas", ["0.25..0,0.6", "1.4..0,1.9"])
def test_gray_stays_gray(chromas):
    assert chroma(shown(f"material/base_color shade 0,{chromas}", (0.3, 0.3, 0.3))) < 1
