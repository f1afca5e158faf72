# SPDX-License-Identifier: Apache-2.0
"""Values from the names of materials and light sources, compared with measured ones."""

from lab.bench.materials.experiment import run as run
