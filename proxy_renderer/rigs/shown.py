# SPDX-License-Identifier: Apache-2.0
"""What pictures have to show of a rig: the structure of its light, not averages of the image."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from ..claims.claim import Claim
from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..prompt.lexicon.rigs import RigLight
from .chosen import ChosenRig
from .places import Placed
from .stage import LightStage

_ASIDE, _BEHIND, _BEFORE, _ABOVE, _BELOW = 35.0, 125.0, 25.0, 58.0, -12.0
"""Degrees from which light comes from a side, from behind, up to which from the camera, and from which from above and from below."""
_RATIO = 0.45  # share of the stops between key and fill that is left on a subject with bounce and highlights
_LARGE = 3.0  # stops from which key and fill are told apart
_DARK_SKY = -3.0  # stops of a sky before which the subject stands out
_COLD = 7400.0
_GRAYISH = 12.0  # C* from which a light has a color


def claims_of_rig(chosen: ChosenRig, lights: Sequence[Placed], stage: LightStage) -> tuple[Claim, ...]:
    """The claims of the words that a rig stands for: of each word those about its parts.

    Args:
        chosen: The rig of the prompt, with its words.
        lights: Where its lights stand.
        stage: The scene.
    """
    found: list[Claim] = []
    seen: set[tuple[str, str]] = set()
    for word, parts in chosen.words.items():
        mine = [each for each in lights if not parts or each.light.part in parts]
        for claim in _structure(word, chosen, mine, stage):
            if (word, claim.measure) not in seen:
                seen.add((word, claim.measure))
                found.append(claim)
    return tuple(found)


def _structure(word: str, chosen: ChosenRig, lights: Sequence[Placed], stage: LightStage) -> Iterator[Claim]:
    rig = chosen.rig
    key = next((each for each in lights if each.light.part == "key"), None)
    if rig.name == "silhouette":
        yield Claim(word, "subject", "silhouette", "subject", (14.0,), (math.inf,))
        return
    if key is not None and key.light.reach != "background":
        yield from _direction(word, key, stage)
        yield from _color(word, key.light)
        fills = [x.light.stops for x in lights if x.light.part in ("fill", "bounce", "accent", "top")]
        ratio = -max([*fills, rig.world if rig.world is not None else -2.0])
        if ratio >= _LARGE:
            yield Claim(
                word,
                "subject",
                "key_to_fill",
                "subject",
                (min(_RATIO * ratio, 2.2),),
                (math.inf,),
                change=0.6,
            )
        if rig.sky is not None and rig.sky <= _DARK_SKY:
            yield Claim(word, "subject", "standing_out", "subject", (4.0,), (math.inf,), change=8.0)
    for each in lights:
        if each.light.part in ("rim", "kicker") and each.light.stops > 0.0:
            yield Claim(word, "subject", "rim", "subject", (4.0,), (math.inf,), change=5.0)
        if each.light.color and each is not key:
            yield from _accent(word, each.light)


def _direction(word: str, key: Placed, stage: LightStage) -> Iterator[Claim]:
    """Where the key comes from, as the camera sees it."""
    aside = (key.azimuth - stage.front + 180.0) % 360.0 - 180.0
    flat = math.cos(math.radians(key.elevation))
    if key.elevation > _ABOVE:
        yield Claim(word, "subject", "light_up", "subject", (0.35,), (math.inf,), change=0.25)
    elif key.elevation < _BELOW:
        yield Claim(word, "subject", "light_up", "subject", (-math.inf,), (0.0,), change=-0.3)
    if abs(aside) > _BEHIND:
        yield Claim(word, "subject", "light_front", "subject", (-math.inf,), (0.4,), change=-0.25)
    elif abs(aside) > _ASIDE and flat > 0.5:
        sign = math.copysign(1.0, aside)
        ends = ((0.2,), (math.inf,)) if sign > 0 else ((-math.inf,), (-0.2,))
        yield Claim(word, "subject", "light_right", "subject", *ends, change=0.25 * sign)
    elif abs(aside) < _BEFORE and key.elevation < _ABOVE:
        yield Claim(word, "subject", "light_front", "subject", (0.45,), (math.inf,), change=0.25)


def _color(word: str, light: RigLight) -> Iterator[Claim]:
    if light.color:
        yield from _accent(word, light)
    elif light.is_warm:
        yield Claim(word, "subject", "highlight_warmth", "subject", (4.0,), (math.inf,), change=4.0)
    elif light.kelvin >= _COLD:
        yield Claim(word, "subject", "highlight_warmth", "subject", (-math.inf,), (-1.5,), change=-4.0)


def _accent(word: str, light: RigLight) -> Iterator[Claim]:
    """That some of the picture has the color of a light."""
    color = srgb_from_hex(light.color)
    lab = lab_from_srgb(color)
    if chroma(lab) > _GRAYISH:
        direction = tuple(v / chroma(lab) for v in lab[1:])
        yield Claim(
            word,
            "picture",
            "accent",
            "picture",
            (12.0,),
            (math.inf,),
            change=12.0,
            direction=direction,
            color=color,
        )
