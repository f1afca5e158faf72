# SPDX-License-Identifier: Apache-2.0
"""Whether the look follows the words better than a similarity alone makes it: the paper's experiments, and more pairs."""

from lab.bench.paper.experiment import run

__all__ = ["run"]
