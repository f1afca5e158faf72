# SPDX-License-Identifier: Apache-2.0
"""Time of a step of the loop: the renderer's part, beside Mitsuba 3's, and the encoder's."""

from lab.bench.speed.renderer import run as run
