# SPDX-License-Identifier: Apache-2.0
"""A picture in the words' place: looks that are hidden and recovered, carried over to other scenes, and photo filters."""

from lab.bench.like.experiment import run as run
