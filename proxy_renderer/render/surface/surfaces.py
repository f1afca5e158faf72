# SPDX-License-Identifier: Apache-2.0
"""The light that surfaces and the background send to the camera, before any fog."""

from __future__ import annotations

import math
from collections.abc import Sequence

import torch
from torch import Tensor

from ...scene.values import wanted
from ..geometry.vectors import within
from ..lights.prefilter import GLOSSY, SATIN
from ..material.shading_inputs import used
from ..transport.indirect import Gathered
from ..transport.secondary_hits import Table
from .frame import Frame
from .lobes import Light, Reflected
from .principled import shade
from .view_samples import Beam

_BENT = 0.02
"""Difference of IOR over which refracted pictures are compared."""


def beams_of(frame: Frame) -> list[Beam]:
    """What reaches the samples straight from each lamp; a lamp that has moved lights what bounces it anew."""
    beams = [frame.cache.beam(i, lamp, frame.sight, frame.view) for i, lamp in enumerate(frame.lamps)]
    return [beam.through(frame.fog) for beam in beams] if frame.fog.active else beams


def radiance(frame: Frame, beams: list[Beam], table: Table, gathered: Gathered, transparent: bool) -> Tensor:
    """Radiance (3, N + B) of all samples: surfaces in the order of their materials, then background.

    A transparent film has a fourth row: how much of what is behind it a sample covers.

    Args:
        frame: What is rendered.
        beams: From `beams_of`.
        table: Radiances of what secondary rays meet, from `table_of`.
        gathered: The indirect light, gathered after the beams were traced.
        transparent: Whether the film is.
    """
    cache, sight, sky = frame.cache, frame.sight, frame.sky
    gathered = cache.indirect.following(gathered, table, frame.lamps)
    irradiance = gathered.irradiance
    bare = sum(1 for lamp in frame.lamps if not lamp.pictured)
    if beams[bare:]:
        irradiance = irradiance + frame.colors[bare:].T @ _irradiances(beams[bare:])
    around = irradiance / math.pi
    beams = beams[:bare]
    if beams:
        irradiance = irradiance + frame.colors[:bare].T @ _irradiances(beams)
    *levels, behind = cache.worlds(sky, sight)
    tint = sky.color[:, None]
    knots, images = _images(gathered, [level * tint for level in levels], around)
    # One split backs up as one concatenation; a slice for every material would as a picture of zeros each.
    sizes = [stop - start for _, start, stop in cache.samples.slices]
    shares = zip(*(field.split(sizes, 1) for field in (irradiance, *images)), strict=True)
    pieces = []
    for (material, start, stop), (lit, *seen) in zip(cache.samples.slices, shares, strict=True):
        part, paint = slice(start, stop), frame.paints[material]
        incoming = Light(
            irradiance=lit,
            lamps=frame.colors[:bare],
            highlights=[beam.part(part) for beam in beams],
            view=sight.basis[:, part],
            reflected=Reflected(knots, seen),
            behind=_behind(frame, table, gathered, material, part) if used(paint.transmission) else None,
        )
        varying = dict(cache.inputs(material, part, sight))
        texture = varying.pop("base_color", None)
        pieces.append(shade(paint.varied(varying), incoming, texture))
    if not transparent:
        return torch.cat((*pieces, behind * tint), 1)
    shown = torch.cat((*pieces, torch.zeros_like(behind)), 1)
    return torch.cat((shown, cache.covered))


def _irradiances(beams: list[Beam]) -> Tensor:
    return torch.stack([beam.irradiance for beam in beams])


def _images(
    gathered: Gathered, worlds: Sequence[Tensor], around: Tensor
) -> tuple[tuple[float, ...], list[Tensor]]:
    """What surfaces of increasing roughness reflect: the roughnesses, and for each the radiance (3, N).

    Args:
        gathered: The light of surfaces.
        worlds: The world (3, N) in the mirror direction: sharp, a little blurred if it is a picture, and blurred.
        around: (3, N) what the roughest surface reflects.
    """
    sharp, blurred = worlds[0], worlds[-1]
    first = gathered.mirror + sharp * gathered.open_mirror
    last = gathered.glossy + blurred * gathered.open_glossy
    if len(worlds) == 2:
        return (0.0, GLOSSY, 1.0), [first, last, around]
    # Between the two, surfaces are half of either; the world has a level of its own.
    opening = (gathered.open_mirror + gathered.open_glossy) / 2
    between = (gathered.mirror + gathered.glossy) / 2 + worlds[1] * opening
    return (0.0, SATIN, GLOSSY, 1.0), [first, between, last, around]


def table_of(frame: Frame) -> Table:
    """Radiances of what secondary rays meet."""
    rows = zip(frame.paints, frame.cache.mean_texture, strict=True)
    albedos = torch.stack([p.base * mean * (1 - p.transmission) for p, mean in rows])
    glow = torch.stack([p.emission for p in frame.paints])
    sky = frame.sky
    metallic = torch.stack([p.metallic for p in frame.paints])
    return Table.of(within(albedos, 0.0, 1.0), metallic, glow, frame.colors, sky.halves, sky.coefficients())


def _behind(frame: Frame, table: Table, gathered: Gathered, material: int, part: slice) -> Tensor:
    """Radiance (3, n) seen through a transparent material.

    Another IOR bends rays to other places, over edges too: its gradient is a secant between two traced pictures.
    """
    ior = frame.paints[material].ior
    here = float(ior.detach())

    def seen(side: int) -> Tensor:
        behind = frame.cache.behind(material, side, part, max(here + side * _BENT, 1.0), frame.lamps)
        world = frame.sky.seen(behind.toward) * frame.sky.color[:, None]
        return behind.far.image(table, behind.ambient(gathered.anchors).T) + world * behind.far.open

    straight = seen(0)
    if not wanted(ior):
        return straight
    with torch.no_grad():
        # Where a bright lamp comes into view, the picture saturates: the slope is that of x / (1 + x).
        low, high = (light / (1 + light) for light in (seen(-1), seen(1)))
        slope = (high - low) * (1 + straight) ** 2 / (here + _BENT - max(here - _BENT, 1.0))
    return straight + slope * (ior - ior.detach())
