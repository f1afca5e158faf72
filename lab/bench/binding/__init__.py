# SPDX-License-Identifier: Apache-2.0
"""Whether look words of labeled sentences are bound to what they describe."""

from lab.bench.binding.experiment import run as run
