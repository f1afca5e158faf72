# SPDX-License-Identifier: Apache-2.0
"""What is said of pictures that are made for it, and that it reads alike off any picture."""

import numpy as np
import pytest
import torch
from told import bound

from proxy_renderer.claims.measures.picture import MeasuredPicture
from proxy_renderer.reference.regions import regions_of
from proxy_renderer.reference.statements import hue, statements_of

WIDTH, HEIGHT = 160, 120


def grid():
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    return (x + 0.5) / WIDTH, (y + 0.5) / HEIGHT


def ball(color=(0.8, 0.3, 0.2), ground=(0.3, 0.3, 0.32), side=0.0):
    """A ball before a plain ground, lighter on one side."""
    x, y = grid()
    inside = (x - 0.5) ** 2 * (WIDTH / HEIGHT) ** 2 + (y - 0.5) ** 2 < 0.25**2
    light = 1 + side * (x - 0.5) / 0.25
    picture = np.where(inside[..., None], np.array(color) * light[..., None], np.array(ground))
    return picture.clip(0, 1).astype(np.float32), inside


def landscape():
    """A light, even sky over a dark, uneven ground."""
    x, y = grid()
    sky = np.array((0.55, 0.7, 0.9)) + 0.1 * y[..., None]
    ground = np.array((0.2, 0.25, 0.1)) * (1 + 0.6 * np.sin(90 * x) * np.sin(70 * y))[..., None]
    return np.where(y[..., None] < 0.45, sky, ground).astype(np.float32)


def said(display):
    return statements_of(regions_of(display))


def one(display, measure):
    return next(s for s in said(display) if s.claim.measure == measure)


def test_a_subject_is_told_from_a_plain_ground_and_none_where_there_is_none():
    display, inside = ball()
    told = regions_of(display)
    assert told.subject
    shown = told.picture.seen.subject.numpy() > 0.5
    assert (shown & inside).sum() > 0.8 * (shown | inside).sum()
    x, y = grid()
    waves = np.stack([0.5 + 0.3 * np.sin(40 * x + i) * np.sin(31 * y) for i in range(3)], -1)
    assert not regions_of(waves.astype(np.float32)).subject


def test_a_sky_hangs_from_the_upper_border_and_a_plain_wall_is_none():
    told = regions_of(landscape())
    assert told.sky
    sky = told.picture.seen.material.numpy() < 0
    assert sky[: HEIGHT // 3].mean() > 0.9
    assert sky[HEIGHT // 2 :].mean() < 0.1
    assert not regions_of(np.full((HEIGHT, WIDTH, 3), 0.7, np.float32)).sky


def test_shadows_and_lights_are_called_what_they_are():
    x, _ = grid()
    ramp = np.stack([0.1 + 0.85 * x, 0.15 + 0.7 * x, 0.2 + 0.5 * x], -1).astype(np.float32)
    words = {s.claim.measure: s.word for s in said(ramp)}
    assert "yellow" in words["highlight_cast"] or "orange" in words["highlight_tint"]
    assert "blue" in words["shadow_cast"]
    reason = one(ramp, "shadow_cast").claim.reason
    assert reason.startswith("its shadows are")


@pytest.mark.parametrize(("side", "word"), [(0.5, "right"), (-0.5, "left")])
def test_light_comes_from_the_side_that_is_lighter(side, word):
    statement = one(ball(side=side)[0], "from_right")
    assert statement.trait == "light"
    assert word in statement.word


def test_an_even_subject_says_nothing_of_where_light_comes_from():
    assert not [s for s in said(ball()[0]) if s.claim.measure in ("from_right", "from_above")]


def test_haze_and_a_vignette_are_said_only_where_they_are():
    display, _ = ball()
    x, y = grid()
    fall = 1 - 0.8 * ((2 * x - 1) ** 2 + (2 * y - 1) ** 2)[..., None] / 2
    measures = [{s.claim.measure for s in said(p.astype(np.float32))} for p in (display, display * fall)]
    assert "vignette" not in measures[0]
    assert "vignette" in measures[1]
    clear, _ = ball(ground=(0.1, 0.1, 0.12))
    hazy = (0.45 + 0.4 * clear).astype(np.float32)
    assert "veil" not in {s.claim.measure for s in said(clear)}
    assert "veil" in {s.claim.measure for s in said(hazy)}


def test_a_dark_thing_in_two_corners_is_no_vignette():
    display, _ = ball(ground=(0.6, 0.6, 0.6))
    x, y = grid()
    for corners in (x < 0.2, (x < 0.25) | ((x > 0.75) & (y > 0.6))):
        painted = np.where((corners & (abs(y - 0.5) > 0.3))[..., None], 0.1, display).astype(np.float32)
        assert "vignette" not in {s.claim.measure for s in said(painted)}


def test_black_and_white_things_ask_no_scene_for_more_than_what_looks_so():
    x, _ = grid()
    ramp = np.repeat(x[..., None], 3, -1).astype(np.float32)
    assert one(ramp, "black_point").claim.upper[0] == pytest.approx(12.0)
    assert one(ramp, "white_point").claim.lower[0] == pytest.approx(80.0)
    faded = 0.35 + 0.3 * ramp
    assert one(faded, "black_point").claim.lower[0] > 30.0
    assert one(faded, "white_point").claim.upper[0] < 75.0


def test_colors_that_are_more_vivid_than_any_of_the_picture_may_stay_and_not_become_so():
    shown = MeasuredPicture.of(torch.tensor((0.1, 0.9, 0.1)).expand(24, 24, 3), regions_of(ball()[0]).picture.seen)
    claim = bound(one(ball()[0], "vividest"))
    gaudy = claim.value(shown, claim.region(shown.seen))
    assert claim.miss(gaudy, before=torch.zeros(1)) > 3.0
    assert claim.miss(gaudy, before=gaudy) == 0.0


def test_a_picture_keeps_all_that_is_said_of_it_and_another_one_does_not():
    display, _ = ball(side=0.5)
    told = regions_of(display)
    colder = MeasuredPicture(told.picture.display * torch.tensor([0.6, 0.8, 1.0]), told.picture.seen)
    kept, lost = [], []
    for statement in said(display):
        claim = bound(statement)
        where = claim.region(told.picture.seen)
        own = claim.value(told.picture, where)
        kept.append(claim.miss(own, before=own))
        lost.append(claim.miss(claim.value(colder, where), before=own))
    assert max(kept) == 0.0
    assert max(lost) > 3.0


def test_the_mean_of_many_colors_says_less_than_that_of_one():
    x, y = grid()
    plain = np.ones((HEIGHT, WIDTH, 3)) * (0.6, 0.45, 0.3) * (0.7 + 0.3 * y[..., None])
    stripes = np.where((x * 8 % 1 < 0.5)[..., None], plain, plain[..., ::-1])
    widths = []
    for display in (plain, stripes):
        claim = one(display.astype(np.float32), "midtone_cast").claim
        widths.append(claim.upper[0] - claim.lower[0])
    assert widths[1] > 1.5 * widths[0]


def room(paint=(0.9, 0.25, 0.05), light=(1.0, 1.0, 1.0), share=0.45):
    """Gray things of many lightnesses, and one large thing of strong paint, in one light."""
    x, y = grid()
    gray = (0.15 + 0.7 * (np.floor(x * 9) * 5 % 9) / 9)[..., None] * np.ones(3)
    thing = (np.abs(x - 0.5) < share / 2)[..., None]
    shading = (0.35 + 0.65 * y)[..., None]
    return (np.where(thing, np.array(paint), gray) * shading * np.array(light)).astype(np.float32)


def casts(display):
    return {s.claim.measure: s.claim for s in said(display) if s.claim.measure.endswith("_cast")}


def test_paint_is_no_light_however_large_the_painted_thing_is():
    for claim in casts(room()).values():
        assert all(low < 0.0 < high for low, high in zip(claim.lower, claim.upper, strict=True))


def test_light_is_told_whatever_is_painted():
    orange = (1.0, 0.72, 0.4)
    for paint in ((0.9, 0.25, 0.05), (0.35, 0.4, 0.5), (0.5, 0.5, 0.5)):
        statement = one(room(paint, orange, share=0.25), "midtone_cast")
        assert statement.claim.lower[1] > 10.0
        assert "orange" in statement.word or "yellow" in statement.word


def test_black_around_a_picture_in_red_light_does_not_hide_that_it_is_red():
    x, y = grid()
    red = np.array((0.9, 0.35, 0.3)) * (0.6 + 0.4 * y[..., None])
    framed = np.where(((abs(x - 0.5) < 0.4) & (abs(y - 0.5) < 0.4))[..., None], red, 0.01)
    assert casts(framed.astype(np.float32))["midtone_cast"].lower[0] > 12.0


def test_the_light_on_a_subject_is_that_of_the_picture_and_its_paint_is_not_copied():
    display, _ = ball(color=(0.9, 0.2, 0.1), ground=(0.6, 0.6, 0.6))
    statement = next(s for s in said(display) if s.claim.measure == "cast" and s.claim.part == "subject")
    claim = bound(statement)
    assert claim.upper[0] < 15.0
    red = torch.tensor([60.0, 50.0])
    assert claim.miss(red, before=torch.zeros(2)) > 5.0
    assert claim.miss(red, before=red) == 0.0  # what is red already may stay


def test_vivid_paint_asks_for_no_vivid_light_and_pale_colors_for_pale_ones():
    vivid = one(room(share=0.6), "chroma")
    assert "vivid" in vivid.word
    assert vivid.claim.lower[0] < 8.0  # what of it is light, and not paint
    assert one(np.full((HEIGHT, WIDTH, 3), (0.7, 0.4, 0.2), np.float32), "chroma").claim.lower[0] > 15.0
    pale = one(room((0.5, 0.5, 0.5)), "chroma").claim
    assert pale.upper[0] < 8.0


def test_tints_have_names():
    assert hue(0.5, 0.5) == "neutral"
    assert hue(0.0, 6.0) == "slightly yellow"
    assert hue(-20.0, -8.0) == "teal"
    assert hue(5.0, -30.0) == "blue"
