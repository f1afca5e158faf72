# SPDX-License-Identifier: Apache-2.0
"""The update set S_K of a round (equation 7; Algorithm 1, line 6), and the prior on what it holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import torch
from torch import Tensor

from ...guidance.guide import Weights
from ...prompt.types import Plan
from ...schema import VibeError
from ...schema.messages import Options
from ..inner.descent import first_order_gain
from ..objective import RoundObjective
from ..plan import top_k
from ..shots import ShotState
from ..vector import ParameterVector


def select(
    plan: Plan,
    vector: ParameterVector,
    shots: Sequence[ShotState],
    u: Tensor,
    lower: Tensor,
    upper: Tensor,
    options: Options,
    weights: Weights,
) -> list[str]:
    """S_K (equation 7): the K parameters that receive gradients; for the baseline all that can move.

    Args:
        plan: Priorities and priors by key.
        vector: The parameters of u.
        shots: The shots whose losses are probed.
        u: (N,) where they are probed.
        lower: (N,) lower corner of the feasible box.
        upper: (N,) upper corner.
        options: K is `top_k`.
        weights: Of the loss.

    Raises:
        VibeError: Nothing that the words name may change.
    """
    movable = {key: bool((upper > lower)[part].any()) for key, part in vector.slices.items()}
    relevant = {key for key, entry in plan.items() if entry.priority is not None and movable[key]}
    if all(plan[key].prior > 0.0 for key in relevant):
        raise VibeError(
            "Nothing that the words name may change in this scene.",
            "Unlock something, allow more groups, or use other words.",
        )
    if options.baseline:
        return sorted(relevant)
    # Moving the camera means tracing everything again: only words are worth that.
    probed = {k for k in relevant if vector.instances[k].parameter.group != "camera" or plan[k].prior == 0.0}
    free = replace(weights, prior=0.0, hue=0.0)
    probe = RoundObjective(shots, vector, probed, lower, upper, torch.zeros_like(u), free)
    gain = first_order_gain(probe, u, lower, upper)
    return top_k(
        plan, options.top_k, movable, {k: float(gain[part].sum()) for k, part in vector.slices.items()}
    )


def pull(plan: Plan, vector: ParameterVector, chosen: list[str]) -> Tensor:
    """(N,) weight in [0, 1] of the prior: on what is optimized though no word named it.

    Args:
        plan: Priors by key.
        vector: The parameters of u.
        chosen: The keys of S_K.
    """
    weight = torch.zeros(vector.size, dtype=torch.float64)
    for key in chosen:
        weight[vector.slices[key]] = plan[key].prior
    return weight
