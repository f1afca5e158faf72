# SPDX-License-Identifier: Apache-2.0
"""Measures on pictures that are made for them: each rises with what it measures, and tells nothing else."""

from collections.abc import Callable
from dataclasses import replace

import pytest
import torch
from torch import Tensor

from proxy_renderer.claims.claim import Claim, ClaimSet
from proxy_renderer.claims.colors import of_color, tints
from proxy_renderer.claims.measures import MEASURES
from proxy_renderer.claims.measures.picture import MeasuredPicture, region_of
from proxy_renderer.color.floats import srgb_from_hex
from proxy_renderer.color.tensors import linear_from_srgb, oklab_from_srgb, srgb_from_linear
from proxy_renderer.render.surface.view_cache import GBuffer
from proxy_renderer.words.types import Attribute

SIZE = 96


def ball() -> tuple[Tensor, Tensor]:
    """Normals (H, W, 3) of a ball in the middle of a picture, and where it is."""
    y, x = torch.meshgrid(torch.linspace(1.6, -1.6, SIZE), torch.linspace(-1.6, 1.6, SIZE), indexing="ij")
    inside = x * x + y * y < 1
    z = (1 - x * x - y * y).clamp_min(0).sqrt()
    wall = torch.tensor([0.0, 0.0, 1.0]).expand(SIZE, SIZE, 3)
    return torch.where(inside[..., None], torch.stack((x, y, z), -1), wall), inside


def picture(
    display: Tensor | None = None,
    light: tuple[float, float, float] = (0.3, 0.4, 0.6),
    color: tuple[float, float, float] = (0.5, 0.5, 0.5),
    wall: tuple[float, float, float] = (0.3, 0.3, 0.3),
    transmittance: float = 1.0,
) -> MeasuredPicture:
    """A ball of a color before a wall, lit from a direction of the camera's space."""
    normal, inside = ball()
    if display is None:
        shade = (normal @ torch.tensor(light) / torch.tensor(light).norm()).clamp_min(0.05)
        display = torch.where(inside[..., None], torch.tensor(color) * shade[..., None], torch.tensor(wall))
    seen = GBuffer(
        subject=inside.float(),
        material=(~inside).long(),
        materials=("Ball", "Wall"),
        normal=normal,
        transmittance=torch.full((SIZE, SIZE), transmittance),
        pattern=torch.ones(SIZE, SIZE),
    )
    return MeasuredPicture(display.float(), seen)


def spotted(size: float) -> MeasuredPicture:
    """The ball with a highlight of a size, in radii."""
    plain = picture()
    normal, inside = ball()
    near = ((normal - torch.tensor([0.3, 0.4, 0.86])).norm(dim=-1) / size).square()
    light = torch.exp(-near) * inside
    return picture((plain.display + 0.5 * light[..., None]).clamp_max(1))


def graded(change: Callable[[Tensor], Tensor]) -> MeasuredPicture:
    return picture(change(picture(color=(0.8, 0.5, 0.3)).display).clamp(0, 1))


def darkened_corners(amount: float) -> MeasuredPicture:
    y, x = torch.meshgrid(torch.linspace(-1, 1, SIZE), torch.linspace(-1, 1, SIZE), indexing="ij")
    falloff = 1 - amount * (x * x + y * y) / 2
    return picture(picture(wall=(0.6, 0.6, 0.6)).display * falloff[..., None])


def edged(width: float) -> MeasuredPicture:
    """A wall with a shadow whose edge is this many pixels wide."""
    x = torch.arange(SIZE) - 12.0
    light = 0.2 + 0.5 * torch.sigmoid(4 * x / width)
    return picture(light[None, :, None].expand(SIZE, SIZE, 3))


def rimmed(light: float) -> MeasuredPicture:
    normal, inside = ball()
    edge = inside & (normal[..., 2] < 0.35) & (normal[..., 0] > 0)
    plain = picture(color=(0.2, 0.2, 0.2)).display
    return picture(torch.where(edge[..., None], torch.tensor(light), plain))


def mirroring(blur: float) -> MeasuredPicture:
    """The ball as metal before a dark ground below a bright sky; the horizon in it is this wide, in heights of normals."""
    normal, inside = ball()
    sky = 0.2 + 0.6 * torch.sigmoid(8 * (normal[..., 1] - 0.1) / blur)
    return picture(torch.where(inside[..., None], sky[..., None].expand(SIZE, SIZE, 3), torch.tensor(0.3)))


def velvet(amount: float) -> MeasuredPicture:
    """The ball with a glow that grows towards its outline."""
    normal, inside = ball()
    glow = amount * (1 - normal[..., 2]).pow(3) * inside
    return picture((picture(light=(0.3, 0.3, 0.9)).display + glow[..., None]).clamp_max(1.0))


def misty(below: float) -> MeasuredPicture:
    """The ball in air that lets through all of its light at the top of the frame, and less and less down to its bottom."""
    shown = picture()
    passing = 1 - below * torch.linspace(0, 1, SIZE)[:, None].expand(SIZE, SIZE)
    return MeasuredPicture(shown.display, replace(shown.seen, transmittance=passing))


WARM = torch.tensor([1.15, 1.0, 0.75])
RISING = {
    "lightness": ("picture", graded(lambda p: 0.5 * p), graded(lambda p: p)),
    "chroma": ("subject", graded(lambda p: p.mean(-1, keepdim=True).expand_as(p)), graded(lambda p: p)),
    "vividest": ("picture", graded(lambda p: p.mean(-1, keepdim=True).expand_as(p)), graded(lambda p: p)),
    "warmth": ("picture", graded(lambda p: p), graded(lambda p: p * WARM)),
    "shadow_warmth": ("picture", graded(lambda p: p), graded(lambda p: torch.where(p.mean(-1, True) < 0.31, p * WARM, p))),
    "highlight_warmth": ("picture", graded(lambda p: p), graded(lambda p: torch.where(p.mean(-1, True) > 0.4, p * WARM, p))),
    "brown_distance": ("picture", graded(lambda p: p.mean(-1, True) * torch.tensor([1.2, 1.0, 0.7])), graded(lambda p: p.flip(-1))),
    "contrast": ("picture", graded(lambda p: 0.3 + 0.3 * p), graded(lambda p: p)),
    "black_point": ("picture", graded(lambda p: p), graded(lambda p: 0.2 + 0.8 * p)),
    "white_point": ("picture", graded(lambda p: 0.6 * p), graded(lambda p: p)),
    "vignette": ("picture", darkened_corners(0.0), darkened_corners(0.7)),
    "standing_out": ("subject", picture(wall=(0.6, 0.6, 0.6)), picture(wall=(0.1, 0.1, 0.1))),
    "silhouette": ("subject", picture(wall=(0.2, 0.2, 0.2)), picture(color=(0.02, 0.02, 0.02), wall=(0.8, 0.8, 0.8))),
    "separation": ("subject", picture(color=(0.4, 0.4, 0.4)), picture(color=(0.9, 0.2, 0.1))),
    "burnt": ("subject", picture(), picture(torch.ones(SIZE, SIZE, 3))),
    "drowned": ("subject", picture(), picture(torch.zeros(SIZE, SIZE, 3))),
    "clipped": ("subject", picture(), picture(torch.tensor([1.0, 0.2, 0.1]).expand(SIZE, SIZE, 3))),
    "colorfulness": ("picture", picture(), picture(wall=(0.9, 0.1, 0.05))),
    "light_right": ("subject", picture(light=(-0.6, 0.2, 0.4)), picture(light=(0.6, 0.2, 0.4))),
    "light_up": ("subject", picture(light=(0.2, -0.6, 0.4)), picture(light=(0.2, 0.6, 0.4))),
    "light_front": ("subject", picture(light=(0.6, 0.6, 0.1)), picture(light=(0.1, 0.1, 0.9))),
    "hardness": ("surroundings", edged(20.0), edged(1.5)),
    "key_to_fill": ("subject", picture(light=(0.2, 0.2, 0.9)), picture(light=(0.9, 0.2, 0.1))),
    "rim": ("subject", rimmed(0.1), rimmed(0.9)),
    "gloss": ("subject", spotted(0.7), spotted(0.07)),
    "sharpness": ("subject", mirroring(2.0), mirroring(0.2)),
    "unscattered": ("subject", picture(), mirroring(0.4)),
    "sheen": ("subject", velvet(0.0), velvet(0.5)),
    "lower_quartile": ("picture", graded(lambda p: 0.6 * p), graded(lambda p: p)),
    "median": ("picture", graded(lambda p: 0.6 * p), graded(lambda p: p)),
    "upper_quartile": ("picture", graded(lambda p: 0.6 * p), graded(lambda p: p)),
    "spread": ("picture", graded(lambda p: 0.3 + 0.3 * p), graded(lambda p: p)),
    "from_right": ("subject", picture(light=(-0.6, 0.2, 0.4)), picture(light=(0.6, 0.2, 0.4))),
    "from_above": ("subject", picture(light=(0.2, -0.6, 0.4)), picture(light=(0.2, 0.6, 0.4))),
    "veil": ("picture", graded(lambda p: p), graded(lambda p: 0.3 + 0.7 * p)),
    "haze": ("surroundings", picture(transmittance=0.9), picture(transmittance=0.4)),
    "mist_below": ("subject", misty(0.0), misty(0.5)),
    "air_lightness": ("surroundings", picture(wall=(0.3, 0.3, 0.3), transmittance=0.4), picture(wall=(0.7, 0.7, 0.7), transmittance=0.4)),
}  # fmt: skip
"""Measure -> a part, a picture that has little of it, one that has much."""


def taken(name: str, shown: MeasuredPicture, part: str) -> Tensor:
    return MEASURES[name].take(shown, region_of(shown.seen, part))


def test_every_measure_of_one_number_is_tried() -> None:
    assert set(MEASURES) - set(RISING) == {
        "color",
        "tint",
        "off_hue",
        "accent",
        "mean",
        "chromaticity",
        "cast",
        "shadow_cast",
        "midtone_cast",
        "highlight_cast",
    }


@pytest.mark.parametrize("name", RISING)
def test_a_measure_rises_noticeably_with_what_it_measures(name: str) -> None:
    part, little, much = RISING[name]
    assert float(taken(name, much, part) - taken(name, little, part)) > 2 * MEASURES[name].notice


OF_THE_AIR = ("haze", "mist_below")
"""Measures of what fog lets through, which is another picture than that of colors."""


@pytest.mark.parametrize("name", OF_THE_AIR)
def test_measures_of_the_air_have_gradients_that_point_there(name: str) -> None:
    part, little, much = RISING[name]
    way = torch.tensor(0.5, requires_grad=True)
    ends = little.seen.transmittance, much.seen.transmittance
    seen = replace(much.seen, transmittance=ends[0] + way * (ends[1] - ends[0]))
    (slope,) = torch.autograd.grad(taken(name, MeasuredPicture(much.display, seen), part).sum(), way)
    assert slope > 0


@pytest.mark.parametrize("name", [n for n in RISING if n not in OF_THE_AIR])
def test_measures_have_gradients_that_point_there(name: str) -> None:
    part, little, much = RISING[name]
    way = torch.tensor(0.5, requires_grad=True)
    mixed = MeasuredPicture(little.display + way * (much.display - little.display), much.seen)
    (slope,) = torch.autograd.grad(taken(name, mixed, part).sum(), way)
    assert torch.isfinite(slope)
    assert slope > 0


def test_each_of_two_lights_has_its_part_of_the_picture() -> None:
    """Blue on the left and red on the right: the mean has neither, a tenth of the picture each."""
    gray = torch.full((SIZE, SIZE, 3), 0.5)
    lit = gray.clone()
    lit[:, : SIZE // 9] *= torch.tensor([0.4, 0.6, 1.5])
    lit[:, -SIZE // 9 :] *= torch.tensor([1.5, 0.5, 0.4])
    for srgb in ((0.2, 0.3, 0.9), (0.9, 0.2, 0.2)):
        (claim,) = (c for c in tints("", "picture", "picture", srgb) if c.measure == "tint")
        lamp = replace(claim, measure="accent", lower=(12.0,))
        everywhere = torch.ones(SIZE, SIZE, dtype=torch.bool)
        values = [float(c.value(picture(lit), everywhere)) for c in (claim, lamp)]
        assert values[0] < 8 < 12 < values[1]
        shown = lit.clone().requires_grad_()
        lamp.value(picture(shown), everywhere).sum().backward()
        assert shown.grad[:, SIZE // 2].abs().max() == 0  # only where that light falls
        assert shown.grad.abs().max() > 0


def test_a_color_is_that_of_most_of_a_thing() -> None:
    shown = picture(color=(0.1, 0.5, 0.5))
    light, a, b = taken("color", shown, "subject").tolist()
    assert 20 < light < 55
    assert a < -3
    assert abs(b) < 3


def test_highlights_of_another_color_do_not_change_the_color_of_a_thing() -> None:
    """Warm reflections on a third of a glossy teal thing: a bluer paint would not make it more teal."""
    plain = picture(torch.full((SIZE, SIZE, 3), 0.2) * torch.tensor([0.4, 1.0, 1.0]))
    mirrored = plain.display.clone()
    mirrored[:, : SIZE // 3] = torch.tensor([0.8, 0.7, 0.5])
    glossy = MeasuredPicture(mirrored, replace(plain.seen, subject=torch.ones(SIZE, SIZE)))
    matte = MeasuredPicture(plain.display, glossy.seen)
    hues = [taken("color", shown, "subject")[1:] for shown in (matte, glossy)]
    assert torch.allclose(*hues, atol=0.5)


def test_a_small_thing_in_the_light_gives_a_black_picture_contrast() -> None:
    black = picture(torch.zeros(SIZE, SIZE, 3))
    y, x = torch.meshgrid(torch.arange(SIZE), torch.arange(SIZE), indexing="ij")
    small = ((y - 48).square() + (x - 48).square() < 64).float()
    lit = MeasuredPicture(small[..., None] * torch.full((3,), 0.8), replace(black.seen, subject=small))
    contrast, everything = MEASURES["contrast"], torch.ones(SIZE, SIZE, dtype=torch.bool)
    assert small.mean() < 0.05
    assert float(contrast.take(lit, everything)) > 70
    assert float(contrast.take(black, everything)) == pytest.approx(0.0, abs=1e-3)


def test_a_large_picture_is_measured_as_a_small_one() -> None:
    shown = picture(color=(0.8, 0.3, 0.2))
    large = shown.display.repeat_interleave(3, 0).repeat_interleave(3, 1)
    again = MeasuredPicture.of(large, shown.seen)
    assert torch.allclose(again.display, shown.display, atol=1e-5)


@pytest.mark.parametrize("name", ["cast", "midtone_cast", "highlight_cast"])
def test_a_cast_is_what_light_adds_and_not_what_paint_has(name: str) -> None:
    gray, painted = (picture(color=(c, 0.4, 0.4), wall=(0.5, 0.5, 0.5)) for c in (0.4, 0.9))
    warm = MeasuredPicture(gray.display * torch.tensor([1.0, 0.85, 0.6]), gray.seen)
    of_light, of_paint, none = (taken(name, p, "picture") for p in (warm, painted, gray))
    assert float((of_light - none).norm()) > 6.0
    assert float((of_paint - none).norm()) < 3.0


def test_parts_and_materials_are_told_apart() -> None:
    shown = picture()
    assert (region_of(shown.seen, "subject") & region_of(shown.seen, "surroundings")).sum() == 0
    assert torch.equal(region_of(shown.seen, "picture", ("Wall",)), region_of(shown.seen, "surroundings"))
    assert not region_of(shown.seen, "sky").any()


def test_what_words_color_is_left_out_of_the_light_unless_nothing_else_is_seen() -> None:
    shown = picture()
    warm = Claim("warm", "picture", "warmth", "picture", (8.0,), (float("inf"),), apart=(("surroundings", ()),))
    where = warm.region(shown.seen)
    assert where is not None
    assert not (where & region_of(shown.seen, "surroundings")).any()
    everything = replace(warm, apart=(("surroundings", ()), ("picture", ())))
    whole = everything.region(shown.seen)
    assert whole is not None
    assert whole.all()


def test_a_claim_is_missed_by_as_much_as_people_notice() -> None:
    claim = Claim("bright", "picture", "lightness", "picture", (60.0,), (float("inf"),))
    assert claim.miss(torch.tensor([60.0]), None) == 0
    assert claim.miss(torch.tensor([54.0]), None) == pytest.approx(3.0)


def test_a_change_may_be_enough() -> None:
    claim = Claim("warm", "picture", "warmth", "picture", (8.0,), (float("inf"),), change=4.0)
    before = torch.tensor([1.0])
    assert claim.miss(torch.tensor([5.0]), before) == 0
    assert claim.miss(torch.tensor([2.0]), before) == pytest.approx(2.0)
    assert claim.miss(torch.tensor([8.0]), torch.tensor([7.0])) == 0


def test_a_change_is_not_enough_far_from_what_is_wanted() -> None:
    """A blue picture that is a little less blue is not warm."""
    claim = Claim("warm", "picture", "warmth", "picture", (8.0,), (float("inf"),), change=4.0)
    before = torch.tensor([-30.0])
    assert claim.miss(torch.tensor([-26.0]), before) > 1
    assert claim.miss(torch.tensor([0.0]), before) > 1
    assert claim.miss(torch.tensor([4.0]), before) == 0
    dark = Claim("dark", "picture", "lightness", "picture", (12.0,), (40.0,), change=-12.0)
    assert dark.miss(torch.tensor([76.0]), torch.tensor([88.0])) > 1
    assert dark.miss(torch.tensor([64.0]), torch.tensor([88.0])) > 1
    assert dark.miss(torch.tensor([52.0]), torch.tensor([88.0])) == 0


def test_too_much_is_missed_too_unless_the_artist_had_it() -> None:
    """A cool picture is not all blue; one that was that blue before need not change."""
    claim = Claim("cool", "picture", "warmth", "picture", (-30.0,), (-4.0,), change=-4.0)
    assert claim.miss(torch.tensor([-60.0]), torch.tensor([20.0])) == pytest.approx(20.0)
    assert claim.miss(torch.tensor([-1.0]), torch.tensor([3.0])) == 0
    assert claim.miss(torch.tensor([-40.0]), torch.tensor([-40.0])) == 0
    assert claim.miss(torch.tensor([-46.0]), torch.tensor([-40.0])) == pytest.approx(4.0)


def test_what_the_artist_has_of_a_tint_may_stay() -> None:
    claim = Claim("", "subject", "cast", "subject", (-2.0, -2.0), (2.0, 2.0), change=0.0)
    red, bluer, redder = torch.tensor([30.0, 10.0]), torch.tensor([20.0, -12.0]), torch.tensor([40.0, 10.0])
    assert claim.miss(red, before=red) == 0.0
    assert claim.miss(torch.tensor([15.0, 5.0]), before=red) == 0.0
    assert claim.miss(bluer, before=red) == pytest.approx(5.0)
    assert claim.miss(redder, before=red) == pytest.approx(5.0)
    assert claim.miss(red, before=None) > 10.0


def test_residuals_know_what_is_missing_and_fall_towards_it() -> None:
    claims = (
        Claim("bright", "picture", "lightness", "picture", (70.0,), (float("inf"),)),
        Claim("gone", "lamp", "lightness", "subject", (0.0,), (1.0,), materials=("No such material",)),
    )
    dark, light = picture(), picture(torch.full((SIZE, SIZE, 3), 0.5))
    judged = ClaimSet.about(claims, dark)
    assert judged.before[1] is None
    assert judged.words == {"bright"}
    assert [len(r) for r in judged.residuals(dark)] == [1]
    assert float(judged.residuals(light)[0]) < 0
    assert judged.residuals(light)[0].abs() < judged.residuals(dark)[0].abs()


def test_values_are_sought_inside_of_what_holds() -> None:
    """A color near its middle, others two noticeable steps from the end; what a mood stands for counts less."""
    color = Claim("navy", "ball", "color", "subject", (20.0, -4.0, -16.0), (40.0, 4.0, -8.0))
    _, lower, upper = (MEASURES["color"].notice * end for end in color.aim(torch.zeros(3), None))
    assert torch.allclose(lower, torch.tensor([28.5, -0.6, -12.6]))
    assert torch.allclose(upper, torch.tensor([31.5, 0.6, -11.4]))
    dark = Claim("dark", "picture", "lightness", "picture", (-float("inf"),), (30.0,))
    value, _, most = dark.aim(torch.tensor([50.0]), None)
    assert (float(value), float(most)) == (25.0, 13.0)
    light, _, least = replace(dark, weight=0.5).aim(torch.tensor([50.0]), None)
    assert (float(light), float(least)) == (12.5, 6.5)
    assert dark.miss(torch.tensor([30.0]), None) == 0


@pytest.mark.parametrize("stops", [-2.0, 1.0])
def test_exposure_leaves_a_chromaticity_alone(stops: float) -> None:
    """OKLab's three numbers grow alike with light: the cube root of a product is a product."""
    light = torch.tensor([0.2, 0.1, 0.05]).expand(SIZE, SIZE, 3)
    whole = torch.ones(SIZE, SIZE, dtype=torch.bool)
    seen = edged(20.0).seen
    one, other = (
        MEASURES["chromaticity"].take(MeasuredPicture(srgb_from_linear(factor * light), seen), whole)
        for factor in (1.0, 2.0**stops)
    )
    assert torch.allclose(one, other, atol=0.1)


def test_the_color_of_a_subject_is_not_that_of_what_it_shares_with_its_surroundings() -> None:
    """A sofa whose back wears the wall's paper is as brown as its seat."""
    paper, shown = torch.tensor([0.8, 0.8, 0.8]), torch.tensor([0.5, 0.3, 0.1])
    material = (torch.arange(SIZE) < SIZE // 2).long().expand(SIZE, SIZE)
    picture = torch.where(material[..., None] == 1, paper, shown)
    plain = edged(20.0).seen
    seen = replace(plain, subject=torch.ones(SIZE, SIZE), material=material, materials=("Seat", "Paper"))
    claim = Claim("brown", "sofa", "color", "subject", (0.0,) * 3, (100.0,) * 3)
    both, own = (
        claim.value(MeasuredPicture(picture, each), claim.region(each))
        for each in (seen, replace(seen, surrounding=("Paper",)))
    )
    assert torch.allclose(own, 100 * oklab_from_srgb(shown), atol=0.5)
    assert not torch.allclose(both, own, atol=2.0)


def test_the_edges_of_a_pattern_are_no_shadows() -> None:
    squares = torch.arange(SIZE) // 8
    pattern = torch.where((squares[:, None] + squares) % 2 == 0, 1.6, 0.4)
    for width, hard in ((20.0, False), (1.5, True)):
        plain = edged(width)
        seen = replace(plain.seen, pattern=pattern)
        tiled = MeasuredPicture(plain.display * pattern[..., None] / 1.6, seen)
        known, unknown = (
            float(taken("hardness", shown, "surroundings"))
            for shown in (tiled, MeasuredPicture(tiled.display, plain.seen))
        )
        assert unknown > 0.5
        assert (known > 0.2) == hard


def test_paint_is_no_metal_however_glossy_and_whatever_pattern_it_has() -> None:
    """A highlight and a texture are no images of other things."""
    squares = torch.arange(SIZE) // 8
    pattern = torch.where((squares[:, None] + squares) % 2 == 0, 1.4, 0.6)
    plain = picture(light=(0.2, 0.3, 0.9))
    light = linear_from_srgb(plain.display) * pattern[..., None]
    tiled = MeasuredPicture(srgb_from_linear(light), replace(plain.seen, pattern=pattern))
    for painted in (spotted(0.07), tiled):
        assert float(taken("unscattered", painted, "subject")) < 0.1
    assert float(taken("unscattered", mirroring(0.2), "subject")) > 0.2


def test_many_means_at_once_are_what_each_is_alone():
    shown = darkened_corners(0.7)
    boxes = [(i / 4, j / 3, (i + 1) / 4, (j + 1) / 3) for i in range(4) for j in range(3)]
    claims = tuple(Claim("", "picture", "mean", "picture", (0.0,) * 3, (50.0,) * 3, box=b) for b in boxes)
    together = ClaimSet.about((*claims, replace(claims[0], measure="median")), shown)
    for claim, where, value, aim in zip(
        together.claims, together.regions, together.values(shown), together.aims(shown), strict=True
    ):
        alone = claim.value(shown, where)
        assert torch.allclose(value, alone, atol=1e-4)
        for one, other in zip(aim[1:], claim.aim(alone, None), strict=True):
            assert torch.allclose(one, other, atol=1e-4)


def test_air_is_measured_through_a_scene_that_is_all_subject() -> None:
    shown = picture(transmittance=0.3)
    full = MeasuredPicture(shown.display, replace(shown.seen, subject=torch.ones(SIZE, SIZE)))
    haze, tone = (Claim("", "", m, "surroundings", (0.0,), (1.0,)) for m in ("haze", "lightness"))
    for seen in (shown, full):
        where = haze.region(seen.seen)
        assert where is not None
        assert float(haze.value(seen, where)) == pytest.approx(0.7)
    assert tone.region(full.seen) is None


@pytest.mark.parametrize("name", [name for name, each in MEASURES.items() if not each.directed])
def test_a_subject_that_fills_the_image_has_finite_values_or_none(name: str) -> None:
    shown = picture(wall=(0.5, 0.4, 0.3))
    full = MeasuredPicture(shown.display, replace(shown.seen, subject=torch.ones(SIZE, SIZE)))
    claim = Claim("", "", name, "subject", (0.0,), (1.0,))
    where = claim.region(full.seen)
    assert where is None or bool(torch.isfinite(claim.value(full, where)).all())
    assert (where is None) == MEASURES[name].beside


def test_what_glows_is_seen_as_it_is_and_paint_in_dim_light_as_it_would_be_lit():
    where = ball()[1]
    seen = picture(torch.full((*where.shape, 3), 0.6)).seen
    dim = replace(seen, gray=torch.full((*where.shape, 3), 0.1))
    lamp = replace(picture(torch.full((*where.shape, 3), 0.6)), seen=dim)
    paint = replace(picture(torch.full((*where.shape, 3), 0.15)), seen=dim)
    assert torch.allclose(lamp.in_white_light(where).display, lamp.display, atol=1e-4)
    assert paint.in_white_light(where).display.mean() > 1.5 * paint.display.mean()


def test_a_pale_color_is_of_its_hue_or_of_another() -> None:
    """A lime is no yellow, though a pale one is hardly farther from it than a pale lemon."""
    (claim,) = of_color(Attribute("yellow", "", "color", "subject", "subject"), srgb_from_hex("#ffdd00"))

    def aside(code: str) -> float:
        shown = picture(torch.tensor(srgb_from_hex(code)).expand(SIZE, SIZE, 3).clone())
        value = claim.value(shown, claim.region(shown.seen))
        assert claim.oklab(tuple(value.tolist())) == pytest.approx(
            (100 * oklab_from_srgb(torch.tensor(srgb_from_hex(code)))).tolist(), abs=1e-3
        )
        return float(claim.residual(value, None)[2])

    assert aside("#c8bf88") == 0.0
    assert aside("#bbc388") > 0.5
