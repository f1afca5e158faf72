# SPDX-License-Identifier: Apache-2.0
"""Color spaces and differences, one by one."""

import torch
from operation_tests import OperationTests, colors

from proxy_renderer.color import tensors

WHITE, BLACK = torch.ones(1, 3), torch.zeros(1, 3)


class TestLuminance(OperationTests):
    operation = staticmethod(tensors.luminance)
    inputs = (colors(4, 5),)
    shape = (4, 5, 1)
    wrong = (torch.rand(4, 5),)
    values = (((WHITE,), 1.0), ((torch.tensor([0.0, 1.0, 0.0]),), 0.7152))


class TestSrgbFromLinear(OperationTests):
    operation = staticmethod(tensors.srgb_from_linear)
    inputs = (colors(4, 5),)
    shape = (4, 5, 3)
    wrong = (torch.ones(2, 3, dtype=torch.int64),)
    values = (((torch.tensor(0.2140411),), 0.5), ((torch.tensor(0.001),), 0.01292))


class TestLabFromLinear(OperationTests):
    operation = staticmethod(tensors.lab_from_linear)
    inputs = (colors(4, 5),)
    shape = (4, 5, 3)
    wrong = (torch.rand(3, 4),)
    values = (((BLACK,), 0.0), ((torch.full((1, 3), 0.184187),), [50.0, 0.0, 0.0]))


class TestCiede2000(OperationTests):
    """The first and a far pair of the table in Sharma, Wu and Dalal, 2005."""

    operation = staticmethod(tensors.ciede2000)
    inputs = (100 * colors(3), 80 * colors(3))
    shape = (3,)
    wrong = (torch.rand(3, 2), torch.rand(3, 2))
    values = (
        ((torch.tensor([50.0, 2.6772, -79.7751]), torch.tensor([50.0, 0.0, -82.7485])), 2.0425),
        ((torch.tensor([50.0, 2.5, 0.0]), torch.tensor([73.0, 25.0, -18.0])), 27.1492),
    )
