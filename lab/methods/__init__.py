# SPDX-License-Identifier: Apache-2.0
"""Methods that the product is compared with, each a plug-in of `proxy_renderer.optimize.rounds.method`."""

from __future__ import annotations

from typing import NamedTuple

RATE = "LAB_RATE"
"""Environment variable with the greatest step of `adam` and of the baselines, in thousandths of a range."""

BASELINES = {
    "clip-only": "lab.methods.clip:ClipOnly",
    "clip-authors": "lab.methods.clip:ClipAuthors",
    "light-layers": "lab.methods.clip:LightLayers",
}
"""The paper's baselines, and the nearest rival's method. They have a budget of seconds."""

PROJECTION = "projection"
"""The words' ranges and no gradients: the artist's values, projected."""

METHODS = {
    "": "",
    "adam": "lab.methods.adam:Adam",
    **BASELINES,
    PROJECTION: "lab.methods.parts:Projection",
    "bare-rig": "lab.methods.parts:BareRig",
    "middle": "lab.methods.parts:Middle",
    "without-encoder": "lab.methods.parts:WithoutEncoder",
    "every-word": "lab.methods.parts:EveryWord",
    "without-claims": "lab.methods.parts:WithoutClaims",
    "without-sharing": "lab.methods.parts:WithoutSharing",
}
"""Name -> the plug-in; "" for the product's method."""


class Variation(NamedTuple):
    """The product, or another way to search.

    Attributes:
        method: A name of `METHODS`.
        rate: Its greatest step, in thousandths of a range; 0 for its own.
        options: More options of `vibe run`.
    """

    method: str = ""
    rate: int = 0
    options: tuple[str, ...] = ()

    @property
    def environment(self) -> dict[str, str]:
        """The environment variables with which an engine uses it."""
        from proxy_renderer.optimize.rounds.method import VARIABLE  # imports torch

        return {VARIABLE: METHODS[self.method], RATE: str(self.rate)} if self.method else {}

    def __str__(self) -> str:
        rate = f" {self.rate / 10:g} %" if self.rate else ""
        return f"{self.method}{rate} {' '.join(self.options)}".strip() or "ours"


OURS = Variation()
