# SPDX-License-Identifier: Apache-2.0
"""Each term of the objective points where it should; views show what they say."""

import pytest
import torch
import torch.nn.functional as F

from proxy_renderer.guidance import guide as L
from proxy_renderer.guidance import regions


def generator(seed=0):
    return torch.Generator().manual_seed(seed)


def disk(size=64, radius=0.5, center=(0.0, 0.0)):
    axis = torch.linspace(-1, 1, size)
    return ((axis[:, None] - center[1]) ** 2 + (axis[None] - center[0]) ** 2 < radius**2).float()


def picture(subject, surroundings, mask):
    m = mask[..., None]
    return m * torch.tensor(subject) + (1 - m) * torch.tensor(surroundings)


def test_equation_3_and_4():
    text = F.normalize(torch.tensor([[1.0, 0.0], [0.0, 1.0]]), dim=1)
    features = F.normalize(torch.tensor([[3.0, 4.0], [3.0, 4.0]]), dim=1)
    assert L.positive_loss(features, text[:1]).item() == pytest.approx(1 - 0.6)
    assert L.negative_loss(features, text, 0.25).item() == pytest.approx(0.8 - 0.25)
    assert L.negative_loss(features, text, 0.9).item() == 0.0


def test_the_direction_is_that_of_the_words_not_just_away_from_the_start():
    axes = torch.eye(4)
    start, plain, text = axes[0], axes[1:2], F.normalize(axes[1:2] + axes[2:3], dim=1)
    words = F.normalize(start + F.normalize(text - plain, dim=1)[0], dim=0)
    elsewhere = F.normalize(start + axes[3], dim=0)
    still, right, wrong = (L.direction_loss(f[None], start, text, plain).item() for f in (start, words, elsewhere))
    assert still == pytest.approx(1.0, abs=1e-3)
    assert right < 0.5
    assert wrong > right + 0.4
    moving = start.clone()[None].requires_grad_()
    L.direction_loss(moving, start, text, plain).backward()
    assert moving.grad.isfinite().all()


def test_a_subject_on_the_border_costs():
    assert L.border_loss(disk(radius=0.5)).item() == 0.0
    assert L.border_loss(disk(radius=0.5, center=(0.8, 0.0))).item() > 0.05


def test_the_prior_pulls_unnamed_parameters_only():
    where = torch.tensor([0.9, 0.9], requires_grad=True)
    L.prior_loss(where, torch.tensor([0.5, 0.5]), torch.tensor([1.0, 0.0])).backward()
    assert where.grad[0] > 0
    assert where.grad[1] == 0


def test_an_undistorted_full_quad_is_the_picture():
    image = torch.rand(1, 3, 32, 32, generator=generator())
    corners = torch.tensor([[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]])
    torch.testing.assert_close(regions.warp(image, corners, 32), image, atol=1e-4, rtol=0)


def test_quads_stay_inside():
    corners = regions.quads(500, generator())
    assert corners.abs().max() <= 1.0
    assert corners.shape == (500, 4, 2)


def test_crops_keep_most_of_their_region():
    mask = disk(radius=0.3, center=(-0.5, 0.2))
    corners = regions.keeping(mask, 64, generator())
    held = regions.warp(mask[None, None], corners, 64)
    share = held.sum((1, 2, 3)) / mask.sum()  # a crop also magnifies, so this is a lower bound's lower bound
    assert (share > 0.7).all()


def test_subject_views_do_not_show_the_surroundings():
    mask = disk(radius=0.4)
    for surroundings in ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]):
        views = regions.subject_views(picture([0.1, 0.2, 0.9], surroundings, mask), mask, 4, generator(), 32)
        assert views.shape == (4, 3, 32, 32)
        torch.testing.assert_close(views[1, :, 16, 16], torch.tensor([0.1, 0.2, 0.9]), atol=0.02, rtol=0)
        plain = regions.subject_views(picture([0.1, 0.2, 0.9], [0.5, 0.5, 0.5], mask), mask, 4, generator(), 32)
        torch.testing.assert_close(views[1], plain[1], atol=0.05, rtol=0)  # on a random background


def test_surroundings_views_do_not_show_the_subject():
    mask = disk(radius=0.4)
    views = regions.surroundings_views(picture([1.0, 0.0, 0.0], [0.1, 0.4, 0.6], mask), mask, 3, generator(), 32)
    torch.testing.assert_close(
        views, torch.tensor([0.1, 0.4, 0.6])[None, :, None, None].expand_as(views), atol=0.02, rtol=0
    )


def test_an_empty_mask_gives_finite_views():
    display, mask = torch.rand(24, 40, 3), torch.zeros(24, 40)
    for make in (regions.subject_views, regions.surroundings_views):
        assert torch.isfinite(make(display, mask, 2, generator(), 16)).all()
        assert torch.isfinite(make(display, mask + 1.0, 2, generator(), 16)).all()


def test_views_are_reproducible_and_differ_between_seeds():
    display = torch.rand(48, 48, 3, generator=generator(1))
    first, again, other = (regions.whole_views(display, 3, generator(s), 24) for s in (5, 5, 6))
    assert torch.equal(first, again)
    assert torch.equal(first[0], other[0])  # the full frame
    assert not torch.equal(first[1:], other[1:])


def test_the_leash_keeps_a_color_on_the_way_between_its_bounds():
    colors, free = torch.tensor([[0, 1, 2]]), torch.tensor([1.0, 1.0, 1.0])
    assert L.hue_consistency_loss(torch.tensor([0.3, 0.3, 0.3]), colors, free).item() == pytest.approx(0.0)
    assert L.hue_consistency_loss(torch.tensor([0.0, 0.0, 0.9]), colors, free).item() > 0.1
    fixed = torch.tensor([1.0, 1.0, 0.0])  # what cannot move has no say
    assert L.hue_consistency_loss(torch.tensor([0.3, 0.3, 0.0]), colors, fixed).item() == pytest.approx(0.0)
