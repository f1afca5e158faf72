# SPDX-License-Identifier: Apache-2.0
"""Effects whose mode or numbers their parameter cannot have are refused when they are read, not while a scene is planned."""

import pytest
from plan_parts import SCENE, make_instances

from proxy_renderer.planning.light_levels import Sources
from proxy_renderer.planning.ranges import effect_range
from proxy_renderer.schema import PARAMETERS, VibeError
from proxy_renderer.words.lexicon.entries import COLOR_MODES, RANGE_MODES, parse_effect
from proxy_renderer.words.types import Attribute

WORD = Attribute("word", "word", "finish", "subject", color=(0.2, 0.4, 0.6))
NUMBERS = ("0..0", "0.1..0.2", "-5..5", "1e8..1e9", "0.1,0.2..0.3,0.4", "0.1,0.2,0.3..0.4,0.5,0.6", "-1,-1,-1..0,0,0")


@pytest.mark.parametrize(
    ("effect", "remedy"),
    [
        ("film/contrast 1,1..2,2", "Write 1 numbers"),
        ("material/base_color 0.1,0.2..0.3,0.4", "Write 1 or 3 numbers"),
        ("material/base_color shade 0.1..0.2", "Write 2 numbers"),
        ("material/roughness shade 0.1,1..0.2,1", "'shade' is no mode of material/roughness"),
        ("film/contrast lightness 10..20", "'lightness' is no mode of film/contrast"),
        ("light/elevation camera 1..2", "'camera' is no mode of light/elevation"),
        ("film/contrast color #ff0000", "'color' is no mode of film/contrast"),
        ("light/power 0..1", "above 0"),
        ("light/power times -1..1", "negative"),
        ("film/contrast 1..inf", "finite"),
        ("film/contrast nan..nan", "finite"),
        ("film/contrast 1..1e10", "at most 1e+09"),
    ],
)
def test_a_misfit_is_refused_with_its_remedy(effect, remedy):
    with pytest.raises(VibeError) as caught:
        parse_effect(effect)
    assert effect in caught.value.message
    assert remedy in caught.value.remedy


@pytest.mark.parametrize("mode", [*RANGE_MODES, *COLOR_MODES])
def test_what_is_read_can_be_planned(mode):
    """Every mode of every parameter with numbers of all kinds: refused, or a range within the parameter's bounds."""
    instances, read = make_instances(), 0
    by_family = {i.parameter.family: i for i in instances.values()}
    for parameter in PARAMETERS:
        instance = by_family.get(parameter.family)
        if instance is None or parameter.group == "camera":
            continue
        for numbers in ("@", "own", "#204080") if mode in COLOR_MODES else NUMBERS:
            try:
                effect = parse_effect(f"{parameter.group}/{parameter.name} {mode} {numbers}".replace("  ", " "))
            except VibeError:
                continue
            lower, upper = effect_range(effect, WORD, instance, Sources(SCENE, key=1.0))
            assert len(lower) == len(upper) == parameter.components, str(effect)
            pairs = zip(instance.lower, lower, upper, instance.upper, strict=True)
            assert all(a <= b <= c <= d for a, b, c, d in pairs), str(effect)
            read += 1
    assert read > 3
