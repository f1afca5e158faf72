# SPDX-License-Identifier: Apache-2.0
"""Contribution of each part of the method: the development pairs, run with less and less left out."""

from lab.bench.ladder.rungs import run as run
