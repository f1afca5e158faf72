# SPDX-License-Identifier: Apache-2.0
"""Whether the names of measured materials and light sources give what was measured."""

from lab.bench.materials.experiment import run as run
