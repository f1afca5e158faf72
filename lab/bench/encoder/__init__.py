# SPDX-License-Identifier: Apache-2.0
"""How well the encoder reads looks off pictures."""

from lab.bench.encoder.reading import run as run
