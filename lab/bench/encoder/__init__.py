# SPDX-License-Identifier: Apache-2.0
"""Accuracy with which the encoder reads looks off pictures."""

from lab.bench.encoder.reading import run as run
