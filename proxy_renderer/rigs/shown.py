# SPDX-License-Identifier: Apache-2.0
"""What pictures have to show of a rig: the structure of its light, not averages of the image."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

from ..claims.claim import Claim
from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..schema import orbit
from ..words.lexicon.rigs import RigLight
from .chosen import ChosenRig
from .places import Placed
from .stage import LightStage

_ASIDE, _BEHIND, _BEFORE = 0.6, -0.5, 0.85
"""Cosines with the camera's axes from which light comes from a side, from behind, and from the camera."""
_SEEN = 0.2  # what a measure of direction has, at least, where the side of the light is seen
_RATIO = 0.45  # share of the stops between key and fill that is left on a subject with bounce and highlights
_LARGE = 3.0  # stops from which key and fill are told apart
_DARK_SKY = -3.0  # stops of a sky before which the subject stands out
_COLD = 7400.0
_GRAYISH = 12.0  # C* from which a light has a color


def claims_of_rig(chosen: ChosenRig, lights: Sequence[Placed], stage: LightStage) -> tuple[Claim, ...]:
    """The claims of the words that a rig stands for: of each word those about its parts of the rig."""
    found: list[Claim] = []
    seen: set[tuple[object, ...]] = set()
    for word, (parts, aspects) in chosen.words.items():
        mine = [each for each in lights if not parts or each.light.part in parts]
        for aspect, claim in _structure(word, chosen, mine, stage):
            known = (claim.measure, claim.direction)
            if (not aspects or aspect in aspects) and known not in seen:  # the first word has the claim
                seen.add(known)
                found.append(claim)
    return tuple(found)


def _structure(
    word: str, chosen: ChosenRig, lights: Sequence[Placed], stage: LightStage
) -> Iterator[tuple[str, Claim]]:
    """What a word claims of some lights of a rig, each with the aspect of light that it is about."""
    rig = chosen.rig
    key = next((each for each in lights if each.light.part == "key"), None)
    if rig.name == "silhouette":
        yield "rest", Claim(word, "subject", "silhouette", "subject", (14.0,), (math.inf,))
        return
    if key is not None and key.light.reach != "background":
        yield from (("direction", claim) for claim in _direction(word, key, stage))
        yield from (("color", claim) for claim in _color(word, key.light))
        fills = [x.light.stops for x in lights if x.light.part in ("fill", "bounce", "accent", "top")]
        ratio = -max([*fills, rig.world if rig.world is not None else -2.0])
        if ratio >= _LARGE:
            least = (min(_RATIO * ratio, 2.2),)
            yield "contrast", Claim(word, "subject", "key_to_fill", "subject", least, (math.inf,), change=0.6)
        if rig.sky is not None and rig.sky <= _DARK_SKY:
            yield "rest", Claim(word, "subject", "standing_out", "subject", (4.0,), (math.inf,), change=8.0)
    for each in lights:
        if each.light.part in ("rim", "kicker") and each.light.stops > 0.0:
            yield "rim", Claim(word, "subject", "rim", "subject", (4.0,), (math.inf,), change=5.0)
        if each.light.color and each is not key:
            yield from (("color", claim) for claim in _accent(word, each.light))


def _direction(word: str, key: Placed, stage: LightStage) -> Iterator[Claim]:
    """Where the key comes from, as the camera sees it: a light from above is from the front to a camera that looks down."""
    right, up, toward = (sum(a * b for a, b in zip(axis, orbit.direction(key.azimuth, key.elevation), strict=True)) for axis in stage.camera_axes)  # fmt: skip
    if max(abs(right), abs(up)) > _ASIDE:
        measure, slope = ("light_right", right) if abs(right) > _ASIDE else ("light_up", up)
        ends = ((_SEEN,), (math.inf,)) if slope > 0 else ((-math.inf,), (-_SEEN,))
        yield Claim(word, "subject", measure, "subject", *ends, change=math.copysign(0.25, slope))
    if toward < _BEHIND:
        yield Claim(word, "subject", "light_front", "subject", (-math.inf,), (0.4,), change=-0.25)
    elif toward > _BEFORE:
        yield Claim(word, "subject", "light_front", "subject", (0.4,), (math.inf,), change=0.25)


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
        away = tuple(v / chroma(lab) for v in lab[1:])
        claim = Claim(word, "picture", "accent", "picture", (12.0,), (math.inf,), change=12.0)
        yield replace(claim, direction=away, color=color)
