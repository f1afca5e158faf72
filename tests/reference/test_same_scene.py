# SPDX-License-Identifier: Apache-2.0
"""A picture of this very scene is found by its edges, and compared place by place."""

import pytest
import torch
from tiny_job import write_job
from told import bound

from proxy_renderer.optimize.shots import picture_size
from proxy_renderer.reference import statements
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


@pytest.fixture(scope="module")
def proxy(tmp_path_factory):
    scene = load_scene(write_job(tmp_path_factory.mktemp("job")))
    return Proxy(scene, picture_size(scene.resolution, 96))


@pytest.fixture(scope="module")
def home(proxy):
    with torch.no_grad():
        return proxy.render({}).display


def graded(picture):
    """Warmer, darker, with more contrast, and lighter on the left."""
    ramp = torch.linspace(1.2, 0.6, picture.shape[1])[None, :, None]
    return (picture**1.4 * torch.tensor([1.0, 0.75, 0.5]) * ramp).clamp(0, 1)


def test_the_same_scene_is_found_however_it_is_lit_and_graded(home):
    assert statements.is_same(home, home)
    assert statements.is_same(graded(home), home)


def test_another_picture_and_other_proportions_are_not_the_same_scene(home):
    generator = torch.Generator().manual_seed(0)
    noise = torch.rand((12, 16, 3), generator=generator).permute(2, 0, 1)[None]
    blobs = torch.nn.functional.interpolate(noise, home.shape[:2], mode="bicubic")[0].permute(1, 2, 0)
    assert not statements.is_same(blobs.clamp(0, 1), home)
    assert not statements.is_same(home.roll(home.shape[1] // 4, 1), home)
    assert not statements.is_same(home[: home.shape[0] // 2], home)


def test_every_place_and_material_is_compared(proxy, home):
    said = statements.statements_by_place(graded(home), None, proxy.gbuffer({}))
    boxes = {s.claim.box for s in said if s.claim.box}
    assert len(boxes) > 60
    assert {s.material for s in said if s.material}
    picture = statements.MeasuredPicture.of(graded(home), proxy.gbuffer({}))
    for statement in said:
        claim = bound(statement)
        assert claim.miss(claim.value(picture, claim.region(picture.seen)), None) == 0.0
