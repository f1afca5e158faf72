# SPDX-License-Identifier: Apache-2.0
"""The five questions that every differentiable operation of the renderer is asked."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, ClassVar

import pytest
import torch
from jaxtyping import TypeCheckError
from torch import Tensor


class OperationTests:
    """Smoke, shape, exception, value, gradient. A subclass `Test…` says what the operation is, and what it is to give."""

    operation: ClassVar[Callable[..., Tensor]]
    """The operation, as a staticmethod; tensors in, one tensor out."""
    inputs: ClassVar[tuple[Any, ...]]
    """Arguments, tensors in double precision, where the operation is smooth."""
    shape: ClassVar[tuple[int, ...]]
    """Of what comes out."""
    wrong: ClassVar[tuple[Any, ...]]
    """Arguments of a wrong shape."""
    values: ClassVar[Sequence[tuple[tuple[Any, ...], Any]]]
    """Pairs of arguments and what they give, known from elsewhere."""
    rtol: ClassVar[float] = 1e-4
    atol: ClassVar[float] = 1e-5
    """How near values must come: wider only where the operation is a fit or a table."""

    def test_smoke(self):
        assert torch.isfinite(self.operation(*self.inputs)).all()

    def test_shape(self):
        assert self.operation(*self.inputs).shape == self.shape

    def test_exception(self):
        with pytest.raises(TypeCheckError):
            self.operation(*self.wrong)

    def test_value(self):
        for arguments, expected in self.values:
            result = self.operation(*arguments)
            wanted = torch.as_tensor(expected, dtype=result.dtype).expand_as(result)
            torch.testing.assert_close(result, wanted, rtol=self.rtol, atol=self.atol)

    def test_gradient(self):
        inputs = [i.clone().requires_grad_() if isinstance(i, Tensor) else i for i in self.inputs]
        assert torch.autograd.gradcheck(self.operation, inputs)


def colors(*shape: int) -> Tensor:
    """Random colors (..., 3) in double precision, none near black, white or gray."""
    generator = torch.Generator().manual_seed(7)
    base = torch.tensor([0.2, 0.45, 0.7], dtype=torch.float64)
    return base + 0.1 * torch.rand(*shape, 3, generator=generator, dtype=torch.float64)


def number(value: float) -> Tensor:
    """One value in double precision."""
    return torch.tensor(value, dtype=torch.float64)
