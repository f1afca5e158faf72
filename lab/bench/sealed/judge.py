# SPDX-License-Identifier: Apache-2.0
"""The judge: whether finished pictures show what was asked for, by rules that the product does not know."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import torch

from lab.bench.paper import measures
from lab.bench.paper.finished import FinishedPicture
from lab.bench.paper.visible import visibility
from lab.bench.sealed.prompts import STRICT, Looseness, SealedAsk, SealedJob
from lab.bench.sealed.rules import Rule, rule
from proxy_renderer.color.floats import Values, oklab_from_srgb, srgb_from_linear

LEAST = 32
"""Pixels of a thing that are needed to judge it."""

_GRAY = 4.0
"""OKLab chroma, in hundredths, below which a name means a gray."""
_LIGHTNESS, _HUE, _CHROMA, _GRAYNESS = (18.0, 30.0), (25.0, 35.0), (0.5, 0.3), (4.0, 8.0)
"""Greatest distance of a thing from its color: lightness and, for grays, chroma in hundredths of OKLab; hue in degrees; the least
share of the chroma. The second of each counts where the same prompt asks for light or for a grade that changes it."""
_CAST_HUE, _CAST_CHROMA = 40.0, 5.0
"""Greatest distance of a picture's hue from a colored light's, degrees, and the color that it needs, in hundredths."""
_COLORED = 0.1, 0.6, 0.9
"""Quantiles of lightness from and up to which pixels say a thing's hue and chroma, and up to which its lightness."""
_ROUGHNESS = 0.35
"""Greatest distance of roughness from a measured material's."""
_PLAIN, _AS_BEFORE = 0.5, 0.8
"""Visibility of a subject that is seen plainly; and of one that is hardly worse off than in the artist's picture."""


@dataclass(frozen=True)
class Finding:
    """One measure of an ask.

    Attributes:
        says: What was measured.
        amount: How much; None where the report has no such value.
        wanted: In words.
        holds: Whether it is so.
    """

    says: str
    amount: float | None
    wanted: str
    holds: bool


Judged = tuple[SealedAsk, bool | None, list[Finding]]
"""An ask, whether it holds (None where its thing is hardly in view), and what was found."""


@dataclass(frozen=True)
class Evidence:
    """The subject of a judgment.

    Attributes:
        before: The artist's picture.
        after: The finished one.
        values: Of the finished scene: `parameters` of report.json, by key.
    """

    before: FinishedPicture
    after: FinishedPicture
    values: Mapping[str, Mapping[str, Any]]

    @property
    def subject_is_seen(self) -> bool:
        """True if the subject can be seen, or was as hard to see in the artist's picture."""
        whole, was = (visibility(shot, self.before, False).whole for shot in (self.after, self.before))
        return whole >= min(_PLAIN, _AS_BEFORE * was)

    def has(self, region: str) -> bool:
        """True if enough of a region is in view."""
        return bool(self.after.region(region).sum() >= LEAST)

    def value(self, material: str, name: str) -> Any:
        """A parameter's final value; None where the material has no such parameter."""
        return self.values.get(f"material/{material}/{name}", {}).get("after")


def judged(job: SealedJob, evidence: Evidence) -> list[Judged]:
    """The verdict on every ask of a job."""
    rows: list[Judged] = []
    for ask in job.asks:
        if not all(map(evidence.has, ask.regions)):
            rows.append((ask, None, []))
            continue
        found = findings(ask, evidence, job.looseness)
        rows.append((ask, all(each.holds for each in found), found))
    return rows


def findings(ask: SealedAsk, evidence: Evidence, loose: Looseness = STRICT) -> list[Finding]:
    """All that an ask is judged by.

    Args:
        evidence: The pictures and the final values.
        loose: What else of the prompt changes how colors look.
    """
    found = [_ruled(rule(name), ask, evidence) for name in ask.shows]
    if ask.material is not None:
        found += _material(ask.part, ask.material, evidence, loose)
    elif ask.kind == "lamp" and ask.color is not None:
        found += cast(evidence.after, ask.color)
    elif ask.color is not None:
        found += named(evidence.after, ask.part, ask.color, loose)
    return found


def _ruled(rule: Rule, ask: SealedAsk, evidence: Evidence) -> Finding:
    if rule.value:
        value = evidence.value(ask.part, rule.value)
        return Finding(rule.value, value, rule.wanted, value is not None and rule.holds(value, None))
    region = ask.part if rule.part == "thing" else rule.part
    after, before = (measures.taken(rule.measure, shot, region) for shot in (evidence.after, evidence.before))
    return Finding(rule.measure, round(after, 3), rule.wanted, rule.holds(after, before))


def named(shot: FinishedPicture, region: str, srgb: Values, loose: Looseness) -> list[Finding]:
    """True if a thing has a color, by OKLab: lightness, and chroma and hue, or, for a gray, that there is no color.

    Args:
        region: See `FinishedPicture.region`.
        srgb: The color, sRGB-encoded.
        loose: What else of the prompt changes how colors look.
    """
    lightness, chroma, hue = _lch(_seen(shot, region))
    wanted = _lch(_hundredths(srgb))
    allowed = _LIGHTNESS[loose.lightness]
    within = f"{wanted[0]:.0f} ± {allowed:g}"
    light = Finding("OKLab lightness", round(lightness, 1), within, abs(lightness - wanted[0]) <= allowed)
    return [light, *_tinted(chroma, hue, wanted, loose.tint)]


def _tinted(chroma: float, hue: float, wanted: Values, loose: bool) -> list[Finding]:
    """Chroma and hue against a color's; of a gray the chroma alone."""
    _, wanted_chroma, wanted_hue = wanted
    if wanted_chroma < _GRAY:
        most = _GRAYNESS[loose]
        return [Finding("OKLab chroma", round(chroma, 1), f"at most {most:g}", chroma <= most)]
    least = _CHROMA[loose] * wanted_chroma
    apart, allowed = _turn(hue, wanted_hue), _HUE[loose] * max(1.0, 2 * _GRAY / wanted_chroma)
    return [
        Finding("OKLab chroma", round(chroma, 1), f"at least {least:.1f}", chroma >= least),
        Finding("degrees of hue apart", round(apart, 1), f"at most {allowed:.0f}", apart <= allowed),
    ]


def cast(shot: FinishedPicture, srgb: Values) -> list[Finding]:
    """True if a whole picture has the hue of a colored lamp.

    Args:
        srgb: The color of the lamp's light, sRGB-encoded.
    """
    _, chroma, hue = _lch(_seen(shot, "picture"))
    apart = _turn(hue, _lch(_hundredths(srgb))[2])
    return [
        Finding("OKLab chroma", round(chroma, 1), f"at least {_CAST_CHROMA:g}", chroma >= _CAST_CHROMA),
        Finding("degrees of hue apart", round(apart, 1), f"at most {_CAST_HUE:g}", apart <= _CAST_HUE),
    ]


def _material(part: str, row: Mapping[str, Any], evidence: Evidence, loose: Looseness) -> list[Finding]:
    """A metal by its values and its tint, something clear by its values, all else by its color and its roughness too."""
    metal, clear = row["metalness"] >= 0.5, row["transmission"] >= 0.5
    srgb = srgb_from_linear([min(c, 1.0) for c in row["color"]])
    found = [_near("metallic", evidence.value(part, "metallic"), float(metal), 0.2)]
    if clear:
        return [*found, _near("transmission", evidence.value(part, "transmission"), 1.0, 0.5)]
    if metal:
        _, chroma, hue = _lch(_seen(evidence.after, part))
        return [*found, *_tinted(chroma, hue, _lch(_hundredths(srgb)), loose=True)]
    found.append(_near("roughness", evidence.value(part, "roughness"), row["roughness"], _ROUGHNESS))
    return found + named(evidence.after, part, srgb, loose)


def _near(name: str, value: float | None, wanted: float, allowed: float) -> Finding:
    holds = value is not None and abs(value - wanted) <= allowed + 1e-6
    return Finding(name, value, f"{wanted:g} ± {allowed:g}", holds)


def _seen(shot: FinishedPicture, region: str) -> Sequence[float]:
    """The mean color of a region without its deepest shadows and its highlights, OKLab in hundredths.

    Hue and chroma are those of its darker part: where it is glossy, the rest has those of the lights.
    """
    seen = shot.measured.oklab[torch.from_numpy(shot.region(region))]
    low, matte, high = torch.quantile(seen[:, 0], seen.new_tensor(_COLORED))
    plain, dark = (seen[(seen[:, 0] >= low) & (seen[:, 0] <= end)].mean(0) for end in (high, matte))
    return [float(plain[0]), float(dark[1]), float(dark[2])]


def _hundredths(srgb: Sequence[float]) -> Sequence[float]:
    return [100 * c for c in oklab_from_srgb(srgb)]


def _lch(oklab: Sequence[float]) -> Values:
    light, a, b = oklab
    return light, math.hypot(a, b), math.degrees(math.atan2(b, a))


def _turn(hue: float, other: float) -> float:
    """Degrees from a hue to another, the shorter way."""
    return abs((hue - other + 180.0) % 360.0 - 180.0)
