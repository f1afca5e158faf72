# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures of claims on real renders: a scene that is moved along a measure is seen to rise in it.

Gloss, vignette, hardness and the light's direction are tried in `lab/bench/test_paper.py`, on the same studio.
"""

import pytest
import torch
from studio import Studio

from proxy_renderer.claims.measures import MEASURES
from proxy_renderer.claims.measures.picture import MeasuredPicture, region_of
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene

GRAY, RED = (0.35, 0.35, 0.35), (0.5, 0.05, 0.04)
METAL = {"material__Ball__metallic": 1.0}
# measure, part, the values of a picture that has little of it, and of one that has much
MOVES = [
    ("lightness", "picture", {"film__exposure": -1.0}, {}),
    ("chroma", "picture", {"film__saturation": 0.3}, {"film__saturation": 1.5}),
    ("vividest", "picture", {"film__saturation": 0.3}, {"film__saturation": 1.5}),
    ("warmth", "picture", {"light__Key__temperature": 12000.0}, {"light__Key__temperature": 2600.0}),
    ("shadow_warmth", "picture", {}, {"film__lift": (1.1, 1.0, 0.85)}),
    ("highlight_warmth", "picture", {}, {"film__gain": (1.3, 1.0, 0.6)}),
    ("contrast", "picture", {"film__contrast": 0.7}, {"film__contrast": 1.4}),
    ("black_point", "picture", {}, {"film__lift": (1.2, 1.2, 1.2)}),
    ("white_point", "picture", {"film__exposure": -1.5}, {}),
    ("standing_out", "subject", {"material__Ball__base_color": (0.02, 0.02, 0.02)}, {"material__Ball__base_color": (0.8, 0.8, 0.8)}),
    ("silhouette", "subject", {}, {"material__Ball__base_color": (0.01, 0.01, 0.01), "material__Ball__specular": 0.0}),
    ("separation", "subject", {"material__Ball__base_color": GRAY}, {"material__Ball__base_color": RED}),
    ("burnt", "subject", {}, {"film__exposure": 9.0}),
    ("drowned", "subject", {}, {"film__exposure": -8.0}),
    ("light_front", "subject", {"light__Key__azimuth": 90.0}, {"light__Key__azimuth": 0.0}),
    ("key_to_fill", "subject", {"world__strength": 4.0}, {"world__strength": 0.0}),
    ("rim", "subject", {"light__Key__azimuth": 0.0}, {"light__Key__azimuth": 150.0}),
    ("unscattered", "subject", {"material__Ball__metallic": 0.0}, {"material__Ball__metallic": 1.0}),
    ("unscattered", "subject", {"material__Ball__transmission": 0.0}, {"material__Ball__transmission": 1.0}),
    ("sharpness", "subject", {"material__Ball__roughness": 0.5} | METAL, {"material__Ball__roughness": 0.05} | METAL),
    ("sheen", "subject", {"material__Ball__roughness": 0.8}, {"material__Ball__roughness": 0.8, "material__Ball__sheen": 1.0}),
]  # fmt: skip


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    return Studio(tmp_path_factory.mktemp("studio"))


def taken(studio, name, part, values):
    shown = studio.shoot(**values).measured
    return MEASURES[name].take(shown, region_of(shown.seen, part))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "part", "little", "much"), MOVES, ids=[row[0] for row in MOVES])
def test_a_measure_rises_on_cycles_pictures(studio, name, part, little, much):
    rise = taken(studio, name, part, much) - taken(studio, name, part, little)
    assert float(rise[0]) > 2 * MEASURES[name].notice


def test_a_color_and_a_tint_turn_where_the_scene_does(studio):
    red = taken(studio, "color", "subject", {"material__Ball__base_color": RED})
    blue = taken(studio, "color", "subject", {"material__Ball__base_color": (0.03, 0.06, 0.5)})
    assert red[1] > 5 > -5 > blue[2]
    pink = taken(studio, "tint", "surroundings", {"light__Key__color": (1.0, 0.3, 0.6)})
    assert float(pink[0]) > float(taken(studio, "tint", "surroundings", {})[0]) + 5


BLUE_LIGHT = {"light__Key__color": (0.25, 0.35, 1.0), "world__color": (0.02, 0.03, 0.1)}


@pytest.mark.parametrize("paint", [(0.6, 0.03, 0.02), (0.8, 0.8, 0.8)])
def test_the_color_of_a_thing_is_that_in_its_light(studio, paint):
    """In blue light a red ball is nearly as red as in white light, and a white one nearly as white; in that nothing changes."""

    def seen(**light):
        values = light | {"material__Ball__base_color": paint}
        display = studio.shoot(**values).measured.display.float()
        tensors = {key.replace("__", "/"): torch.tensor(value) for key, value in values.items()}
        picture = MeasuredPicture(display, Proxy(load_scene(studio.job.folder), (96, 96)).gbuffer(tensors))
        where = region_of(picture.seen, "subject")
        return [MEASURES["color"].take(p, where)[1:] for p in (picture, picture.in_white_light(where))]

    (plain, same), (bluish, adapted) = seen(), seen(**BLUE_LIGHT)
    assert (same - plain).norm() < 0.2
    assert (adapted - plain).norm() < 0.65 * (bluish - plain).norm()


@pytest.mark.parametrize("density", [0.0, 0.05])
def test_what_the_air_lets_through_is_what_a_homogeneous_fog_does(studio, density):
    proxy = Proxy(load_scene(studio.job.folder), (64, 64))
    values = {"volume/density": torch.tensor([density])}
    with torch.no_grad():
        seen, depth = proxy.gbuffer(values), proxy.render(values).depth
    near = (seen.material >= 0) & (depth < 8)
    apart = (seen.transmittance - torch.exp(-density * depth))[near].abs()
    assert float(apart.quantile(0.9)) < 0.02  # pixels on outlines see two distances
    assert set(seen.material.unique().tolist()) <= {-1, *range(len(seen.materials))}
    assert float(seen.subject.max()) == 1.0


def test_mist_that_thins_with_height_hides_the_foot_and_leaves_the_head(studio):
    proxy = Proxy(load_scene(studio.job.folder), (64, 64))
    measure, hidden = MEASURES["mist_below"], []
    for falloff in (0.0, 1.5):
        fog = {"volume/density": torch.tensor([0.3]), "volume/falloff": torch.tensor([falloff])}
        seen = proxy.gbuffer(fog)
        shown = MeasuredPicture(torch.zeros(*seen.subject.shape, 3), seen)
        hidden.append(float(measure.take(shown, region_of(seen, "subject"))[0]))
    assert abs(hidden[0]) < measure.notice
    assert hidden[1] > 2 * measure.notice
