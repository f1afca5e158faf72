# SPDX-License-Identifier: Apache-2.0
"""Wishes for the visible light of a rig: its structure, not averages of the image."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ..color.floats import chroma, lab_from_srgb, srgb_from_hex
from ..goals.wish import Wish
from ..schema import orbit
from ..words.lexicon.quantities import ClaimText, quantities
from ..words.lexicon.rigs import RigLight
from ..words.types import Attribute
from .chosen import ChosenRig
from .places import Placed
from .stage import LightStage


def wishes_of_rig(chosen: ChosenRig, lights: Sequence[Placed], stage: LightStage) -> tuple[Wish, ...]:
    """The wishes of the words that a rig serves: for each word, claims on the light of its parts of the rig."""
    found: list[Wish] = []
    for word, (parts, aspects) in chosen.words.items():
        attribute = Attribute(word, "", "lighting", "whole", "light")
        mine = [each for each in lights if not parts or each.light.part in parts]
        for aspect, claim in _structure(chosen, mine, stage):
            if not aspects or aspect in aspects:
                found.append(Wish(attribute, quantities().of_claim(claim), claims=(claim,)))
    return tuple(found)


def _structure(chosen: ChosenRig, lights: Sequence[Placed], stage: LightStage) -> Iterator[tuple[str, ClaimText]]:
    """(aspect of light, claim) for each claim about some `lights` of a rig; aspects as in `Asked`."""
    rig = chosen.rig
    key = next((each for each in lights if each.light.part == "key"), None)
    if rig.name == "silhouette":
        yield "rest", ClaimText("subject", "silhouette", (14.0,))
        return
    if key is not None and key.light.reach != "background":
        yield from (("direction", claim) for claim in _direction(key, stage))
        yield from (("color", claim) for claim in _color(key.light))
        fills = [x.light.stops for x in lights if x.light.part in ("fill", "bounce", "accent", "top")]
        ratio = -max([*fills, rig.world if rig.world is not None else -2.0])
        if ratio >= 3.0:  # stops, of which bounce and highlights leave less on the subject
            yield "contrast", ClaimText("subject", "key_to_fill", (min(0.45 * ratio, 2.2),), change=0.6)
        if rig.has_dark_sky:
            yield "rest", ClaimText("subject", "standing_out", (4.0,), change=8.0)
            yield "rest", ClaimText("picture", "lightness", upper=(40.0,))  # a white room full of light is no night
    for each in lights:
        if each.light.part in ("rim", "kicker") and each.light.stops > 0.0:
            own = ClaimText("subject", "rim", (4.0,), change=5.0)
            yield "rim", replace(own, lower=(2.0,), change=None, by=True) if chosen.anew else own
        if each.light.color and each is not key:
            yield from (("color", claim) for claim in _color(each.light))


def _direction(key: Placed, stage: LightStage) -> Iterator[ClaimText]:
    """Claims about the key's direction in the camera's view: if the camera looks down, light from above is frontal."""
    camera = np.array(orbit.frame(stage.front, stage.scene.value("camera/elevation")[0]))
    right, up, toward = (np.array(orbit.direction(key.azimuth, key.elevation)) @ camera).tolist()
    if max(abs(right), abs(up)) > 0.6:  # cosine
        measure, slope = ("light_right", right) if abs(right) > 0.6 else ("light_up", up)
        ends = ((0.2,), (math.inf,)) if slope > 0 else ((-math.inf,), (-0.2,))
        yield ClaimText("subject", measure, *ends, math.copysign(0.25, slope))
    if toward < -0.5:
        yield ClaimText("subject", "light_front", upper=(0.4,), change=-0.25)
    elif toward > 0.85:
        yield ClaimText("subject", "light_front", (0.4,), change=0.25)


def _color(light: RigLight) -> Iterator[ClaimText]:
    """The claim that some of the image has the color of a light; none for a nearly gray light."""
    if light.color:
        if chroma(lab_from_srgb(srgb_from_hex(light.color))) > 12.0:
            yield ClaimText("picture", "accent", (12.0,), change=12.0, color=light.color)
    elif light.is_warm:
        yield ClaimText("subject", "highlight_warmth", (4.0,), change=4.0)
    elif light.kelvin >= 7400.0:
        yield ClaimText("subject", "highlight_warmth", upper=(-1.5,), change=-4.0)
