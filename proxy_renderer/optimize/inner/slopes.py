# SPDX-License-Identifier: Apache-2.0
"""How what is judged at a point changes from there, by backward passes or by differences."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import torch
from torch import Tensor

from ..least_squares import Assessment, Slopes

_NEAR = 5.0
"""Noticeable steps inside of an end of what is wanted, from where one step does not lose it."""


def asked(found: Assessment) -> Tensor:
    """(M,) bool: values that a step might bring out of what is wanted."""
    return (found.values < found.lower + _NEAR) | (found.values > found.upper - _NEAR)


def gradients(found: Assessment, leaves: Sequence[Tensor]) -> list[Tensor]:
    """For each of the leaves, (M + 1, ...) the gradients of the values, 0 for those that are not asked for, and of the rest."""
    rows = [*found.values.unbind(), found.rest]
    wanted = [*asked(found).tolist(), True]
    passes = []
    for row, is_wanted in zip(rows, wanted, strict=True):
        some: tuple[Tensor | None, ...] = (None,) * len(leaves)
        if is_wanted and row.requires_grad:
            some = torch.autograd.grad(row, leaves, retain_graph=True, allow_unused=True)
        passes.append(
            [torch.zeros_like(leaf) if g is None else g for g, leaf in zip(some, leaves, strict=True)]
        )
    return [torch.nan_to_num(torch.stack(each), 0.0, 0.0, 0.0) for each in zip(*passes, strict=True)]


def backward_slopes(assess: Callable[[Tensor], Assessment], u: Tensor, chosen: Tensor) -> Slopes:
    """Slopes by backward passes: one for each value that is asked for, and one for the rest.

    Args:
        assess: What is judged at a point, differentiable in it.
        u: (N,) the point.
        chosen: (N,) bool, the n components.
    """
    point = u.detach().clone().requires_grad_()
    found = assess(point)
    (slopes,) = gradients(found, [point])
    return Slopes(found.detached(), slopes[:-1, chosen], slopes[-1, chosen])


@torch.no_grad()
def difference_slopes(
    assess: Callable[[Tensor], Assessment], u: Tensor, chosen: Tensor, strides: Tensor
) -> Slopes:
    """Slopes by differences: one for each component.

    Args:
        assess: What is judged at a point.
        u: (N,) the point.
        chosen: (N,) bool, the n components.
        strides: (N,) moves at which differences are taken.
    """
    here = assess(u)
    columns, rest = [], []
    for i in chosen.nonzero()[:, 0]:
        stride = strides[i]
        there = assess(u.index_add(0, i[None], stride[None]))
        columns.append((there.values - here.values) / stride)
        rest.append((there.rest - here.rest) / stride)
    slopes = torch.nan_to_num(torch.stack(columns, 1), 0.0, 0.0, 0.0)
    return Slopes(here, slopes, torch.nan_to_num(torch.stack(rest), 0.0, 0.0, 0.0))
