# SPDX-License-Identifier: Apache-2.0
"""Products and look-ups that are written out for speed, against what torch makes of the plain formula."""

from __future__ import annotations

import pytest
import torch
from torch.nn import functional

from lab.bench.scenes import outdoors
from proxy_renderer.color.tensors import trilinear
from proxy_renderer.render.geometry.gather_points import SparseWeights
from proxy_renderer.render.geometry.vectors import cross, dot
from proxy_renderer.render.proxy import Proxy


def test_a_spread_is_its_dense_matrix():
    rows, columns = torch.tensor([0, 2, 3]), torch.tensor([[1, 4], [2, 2], [0, 1]])
    weights = torch.tensor([[0.5, 0.25], [1.0, 2.0], [3.0, 4.0]])
    dense = torch.zeros(5, 6)
    dense.index_put_((rows[:, None].expand_as(columns), columns), weights, accumulate=True)
    values = torch.rand(6, 3, requires_grad=True)
    found = SparseWeights(rows, columns, weights, (5, 6))(values)
    assert torch.allclose(found, dense @ values)
    gradient = torch.rand(5, 3)
    found.backward(gradient)
    assert torch.allclose(values.grad, dense.T @ gradient)


@pytest.mark.parametrize("count", [1, 5])
def test_gradients_of_products(count):
    a = torch.rand(3, 5, dtype=torch.float64, requires_grad=True)
    b = torch.rand(3, count, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(dot, (a, b))
    whole = b.expand(3, 5)
    assert torch.autograd.gradcheck(lambda a, b: cross(a, b.expand(3, 5)), (a, b))
    assert torch.allclose(cross(a, whole), torch.linalg.cross(a, whole, dim=0))


@pytest.mark.parametrize("count", [1, 16, 37])
def test_look_ups_in_parts_are_those_of_the_whole(count):
    table, place = torch.rand(1, 2, 3, 4, 5), torch.rand(count, 3) * 2 - 1
    whole = functional.grid_sample(table, place.view(1, -1, 1, 1, 3), align_corners=True).view(2, -1)
    assert torch.allclose(trilinear(table, place), whole)


def test_fog_that_changes_its_shape_is_measured_anew():
    proxy, changed = Proxy(outdoors(2, 2), (32, 32)), {"volume/falloff": torch.tensor([2.0])}
    before = proxy.render({}).linear
    after = proxy.render(changed).linear
    assert (after - before).abs().max() > 1e-3
    assert torch.equal(after, Proxy(outdoors(2, 2), (32, 32)).render(changed).linear)
    assert torch.equal(before, proxy.render({}).linear)
