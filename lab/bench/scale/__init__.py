# SPDX-License-Identifier: Apache-2.0
"""Growth of time and memory with triangles, lights, materials, pixels and shots."""

from lab.bench.scale.experiment import run as run
