# SPDX-License-Identifier: GPL-3.0-or-later
"""All properties that hide, replace or multiply, and the plain scene with some of them."""

from __future__ import annotations

from bpy.types import Object, Scene
from vibe_render.core import rendered

from . import hiding, imaging, lighting
from .plain import AddProperty, plain

HONORED = (*hiding.HONORED, *lighting.HONORED, *imaging.HONORED)
"""The prediction shows what a render shows."""
REPORTED = hiding.REPORTED | lighting.REPORTED | imaging.REPORTED
"""A note says what the prediction leaves out; part of its text."""
LAST = (hiding.odd_names, imaging.unused_compositor, imaging.muted_compositor)
"""These are added after the others, whose parts they change."""


def build(scene: Scene, *added: AddProperty) -> Object:
    """The plain scene with some properties; returns its subject."""
    subject = plain(scene)
    for add in sorted(added, key=lambda each: (each in LAST, each is not hiding.unused_first_layer)):
        add(scene, subject)
    rendered.layer(scene).update()
    return subject
