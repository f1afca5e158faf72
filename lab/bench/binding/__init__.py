# SPDX-License-Identifier: Apache-2.0
"""Binding of look words in labeled sentences."""

from lab.bench.binding.experiment import run as run
