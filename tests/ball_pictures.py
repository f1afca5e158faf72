# SPDX-License-Identifier: Apache-2.0
"""Finished pictures of a ball in the middle, made for measures and judges."""

import numpy as np

from lab.bench.paper.finished import FinishedPicture
from proxy_renderer.color.floats import srgb_from_hex

SIDE = 64
_LINE = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
X, Y = np.meshgrid(_LINE, -_LINE)
RADIUS = 0.6
DISC = np.hypot(X, Y) < RADIUS
HEIGHT = np.sqrt(np.clip(1 - (X**2 + Y**2) / RADIUS**2, 0, 1))
NORMAL = np.where(DISC[..., None], np.stack([X / RADIUS, Y / RADIUS, HEIGHT], -1), 0.0)


def gray(light):
    """A gray picture whose linear light is this (H, W)."""
    light = np.broadcast_to(np.asarray(light, float), (SIDE, SIDE)).clip(0, 1)
    encoded = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    return np.repeat(encoded[..., None], 3, -1)


def shot(display, **more):
    """A ball in the middle."""
    return FinishedPicture(display, DISC.astype(float), NORMAL, np.where(DISC, 0, 1), ("Ball", "Wall"), **more)


def painted(subject, around):
    return shot(np.where(DISC[..., None], srgb_from_hex(subject), srgb_from_hex(around)))


def lit(x, y, z, ambient=0.02):
    """A ball under one distant lamp, before a gray wall."""
    toward = np.array([x, y, z]) / np.linalg.norm([x, y, z])
    return shot(gray(np.where(DISC, ambient + 0.5 * np.clip(NORMAL @ toward, 0, 1), 0.2)))
