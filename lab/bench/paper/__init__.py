# SPDX-License-Identifier: Apache-2.0
"""Looks by the words, compared with looks by a similarity alone: the paper's experiments, and more pairs."""

from lab.bench.paper.experiment import run

__all__ = ["run"]
