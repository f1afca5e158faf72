# SPDX-License-Identifier: Apache-2.0
"""The exponent of a cost: cost ~ size^exponent."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats


@dataclass(frozen=True)
class Exponent:
    """Growth of a cost.

    Attributes:
        slope: Of the line of least squares through the logarithms of all points.
        margin: Half the 95 % interval of the slope (Student's t); infinite for two points.
        last: The slope between the last two points, where what is paid only once counts least.
    """

    slope: float
    margin: float
    last: float


def exponent(sizes: Sequence[float], costs: Sequence[float]) -> Exponent:
    """Fits the exponent of costs that were measured at increasing sizes.

    Args:
        sizes: Two or more, positive.
    """
    x, y = np.log(sizes), np.log(costs)
    from_middle, free = x - x.mean(), len(x) - 2
    spread = float(from_middle @ from_middle)
    slope = float(from_middle @ y) / spread
    rest = y - y.mean() - slope * from_middle
    error = math.sqrt(float(rest @ rest) / free / spread) if free else math.inf
    margin = error * float(stats.t.ppf(0.975, free)) if free else math.inf
    return Exponent(slope, margin, float((y[-1] - y[-2]) / (x[-1] - x[-2])))
