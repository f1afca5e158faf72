# SPDX-License-Identifier: Apache-2.0
"""How well a picture serves as the words: looks that are hidden and recovered, carried over to other scenes, and photo filters."""

from lab.bench.like.experiment import run as run
