# SPDX-License-Identifier: Apache-2.0
"""Results of a vibe on a folder of other people's scenes."""

from lab.bench.wild.corpus import run as run
