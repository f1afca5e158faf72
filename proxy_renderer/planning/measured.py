# SPDX-License-Identifier: Apache-2.0
"""Colors corrected by what the picture shows: light, bounces and the view never do quite what a formula says."""

from __future__ import annotations

import math

from ..color.floats import chroma, lab_from_srgb, srgb_from_lab
from ..prompt.meaning import display_color
from ..prompt.types import PlanContext
from ..schema import Instance, Values
from ..schema.spec import Region
from .display import dimming, first_within, scene_color

_NEAR = math.log(2.5)  # how far the value may be from the formula's for the picture to tell
_DAMPED = 0.8  # share of the error that is mended at once
_MOST = math.log(1.8)  # by which lightness changes at most, and so does a component against the others
_WHITENED, _LEAST = (
    0.6,
    0.85,
)  # share of a cast that is taken out of white, as the eye does in part, and its end
_DARK = 20.0  # L* below which only the hue can be told
_FLOOR = 0.01  # radiance below which there is nothing to measure
_FAINT = 0.002  # the same where only the hue is asked for
_BLACKEST, _WHITEST = 0.006, 0.85
_DIMMEST = 0.3  # share of the wanted light below which there is no use in less


def measured(
    formula: Values, srgb: Values, instance: Instance, context: PlanContext, share: float = 1.0
) -> Values:
    """A surface's linear color that would be displayed as named, judged by how its present one is displayed.

    Args:
        formula: What it would be by the light that is expected; kept where the picture cannot tell.
        srgb: The named color.
        instance: The material's color, or its tint.
        context: The picture, and the values that it shows.
        share: Of what differs that is mended: eyes take out colored light only in part.
    """
    now = context.values.get(instance.key)
    shown = context.picture.materials.get(instance.owner) if context.picture else None
    named = lab_from_srgb(srgb)
    if not (now and shown) or not _near(now, formula):
        return formula
    if named[0] < _DARK:
        return _recast(
            formula, scene_color(srgb, context.view), scene_color(srgb_from_lab(shown), context.view)
        )
    region: Region = "subject" if instance.role == "subject" else "surroundings"
    wanted, seen = srgb_from_lab(display_color(srgb, region)), scene_color(srgb_from_lab(shown), context.view)
    if named[0] > 93 and chroma(named) < 4:  # a cast is taken out of white, not light
        found = _mended(now, wanted, seen, context.view, share)
        return tuple(_WHITEST * max((v / max(found)) ** _WHITENED, _LEAST) for v in found)
    limit = _WHITEST if instance.parameter.name == "base_color" else math.inf
    # As light as can be, and no more saturated than that looks.
    tries = (_mended(now, dimmed, seen, context.view, share) for dimmed in dimming(wanted, _DIMMEST))
    found = first_within(tries, limit)
    top = max(max(found) / limit, 1.0)
    return tuple(max(v / top, _BLACKEST) for v in found)


def _mended(now: Values, wanted: Values, seen: Values, view: str, share: float) -> Values:
    """The value that shows a display color, or nearly, where the present one shows a scene-linear color."""
    logs = [
        share * _DAMPED * math.log(max(w, _FLOOR) / max(s, _FLOOR))
        for w, s in zip(scene_color(wanted, view), seen, strict=True)
    ]
    gain = sum(logs) / 3
    return tuple(v * math.exp(_held(gain) + _held(log - gain)) for v, log in zip(now, logs, strict=True))


def _recast(formula: Values, wanted: Values, seen: Values) -> Values:
    """A dark color without the light's cast, which would make black brown: its lightness cannot be told."""
    (want, see) = ([max(v, _FAINT) for v in color] for color in (wanted, seen))
    level = sum(see) / sum(want)
    ratios = (level * w / s for w, s in zip(want, see, strict=True))
    return tuple(v * min(max(r, 0.5), 2.0) ** _WHITENED for v, r in zip(formula, ratios, strict=True))


def _held(change: float) -> float:
    return min(max(change, -_MOST), _MOST)


def _near(now: Values, formula: Values) -> bool:
    return all(abs(math.log((a + 0.03) / (b + 0.03))) < _NEAR for a, b in zip(now, formula, strict=True))
