# SPDX-License-Identifier: Apache-2.0
"""How time and memory grow with triangles, lights, materials, pixels and shots."""

from lab.bench.scale.experiment import run as run
