# SPDX-License-Identifier: Apache-2.0
"""The strengths of a rig's lights, by which the scene has the rig's exposure and its ratios between lights."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from ..color import tensors
from ..color.constants import LUMINANCE_WEIGHTS
from ..color.tensors import luminance
from ..color.view_transform import ViewTransform
from ..render.geometry.visibility import sphere_points
from ..render.lights.light_source import LightSource
from ..render.lights.light_types import light_sources
from ..scene import SceneData
from ..scene.values import RenderValues
from ..schema import Values
from ..words.lexicon.rigs import Rig
from .places import Placed
from .stage import LightStage, Points

_LEAST_CHANNEL = 1e-4  # on the display


class Exposing:
    """The inverse of a scene's exposure and view transform: the light for a color on the display."""

    def __init__(self, scene: SceneData) -> None:
        film = scene.film
        chosen = film.ocio, film.display, film.view, film.look, film.working_space
        self._view = ViewTransform(*chosen, balance=film.white_balance)
        self._stops = sum(scene.value(key)[0] for key in ("film/exposure", "film/grade_exposure"))
        self._stops += math.log2(max(film.gain, 1e-3))

    def gray(self, luminance: float) -> float:
        """Scene-linear radiance of a gray that is displayed with a luminance, which counts as 0.8 at most."""
        return self.color((min(luminance, 0.8),) * 3)[0]

    def color(self, displayed: Sequence[float]) -> Values:
        """Scene-linear light that is displayed as a linear color, or as a paler one if the view shows none so pure."""
        wanted = torch.tensor(displayed, dtype=torch.float32).clamp(_LEAST_CHANNEL, 0.97)
        gray = wanted @ wanted.new_tensor(LUMINANCE_WEIGHTS)
        for paler in (0.0, 0.12, 0.24, 0.36, 0.48, 0.6):
            aim = light = shown = torch.lerp(wanted, gray, paler)
            for _ in range(48):  # light that comes near the displayed color
                shown = tensors.linear_from_srgb(self._view(light).clamp(0.0, 1.0))
                step = ((aim + _LEAST_CHANNEL) / (shown + _LEAST_CHANNEL)) ** 0.7
                light = (light * step).clamp_max(16.0)
                light = torch.maximum(light, 0.08 * light.max())  # no view shows purer colors
            if float((shown - aim).abs().max()) < 0.03:
                break
        return tuple(v * 2.0**-self._stops for v in light.tolist())


GRAY = 0.18
_LIT = 0.5  # share of the subject that counts as its lit side
_SKY_RAYS = 48
_BARELY = 1e-7


@dataclass(frozen=True)
class Levels:
    """The light that a rig gives to the subject."""

    factors: Mapping[str, float]  # light -> factor on its power in the trial values; 0 if it reaches nothing
    key: float  # irradiance of the key on the subject's lit side
    world: float  # mean irradiance of the subject by a white world of strength 1


def measured(
    scene: SceneData, stage: LightStage, lights: Sequence[Placed], values: dict[str, Values], rig: Rig, ambient: float
) -> Levels:
    """The levels of a rig, from the light that its lights shed with trial `values`.

    `ambient` is the radiance of the scene's own world.
    """
    given = {key: torch.tensor(value) for key, value in values.items()}
    lamps = {lamp.light.name: lamp for lamp in light_sources(scene, RenderValues(scene, given, "cpu"))}
    places = stage.subject, stage.around
    sheds = {x.name: tuple(_shed(lamps[x.name], stage, points) for points in places) for x in lights}
    exposing = Exposing(scene)
    # the key, by the exposure that the rig wants and the subject's own lightness
    albedo = float(stage.subject.albedo.mean()) if len(stage.subject) else GRAY
    albedo = min(max(albedo, 0.05), 0.8)
    kept = 0.7 if albedo > GRAY else 0.42  # exponent: the image keeps this of the subject's lightness
    lit = exposing.gray(GRAY * 2.0**rig.exposure * (albedo / GRAY) ** kept)
    # all light on the subject's lit side, as a multiple of the key's: half of the fills reaches that side, too
    fills = (x.light.stops for x in lights[1:] if x.light.part in ("fill", "bounce", "top", "accent"))
    together = 1.0 + (0.0 if rig.world is None else 2.0**rig.world) + 0.5 * sum(2.0**stops for stops in fills)
    bounce = _bounce(stage, sheds[lights[0].name]) if lights else 0.0
    key = math.pi * lit / albedo / (together + bounce)
    # Greatest radiance of the subject (0) and of its surroundings (1), which may be bright behind a silhouette
    behind = max([0.0, *(x.light.stops for x in lights if x.light.reach == "background")])
    exposures = rig.exposure, rig.exposure + behind
    # highlights of a normally exposed image, which follow most of the rig's exposure
    whites = [exposing.gray(0.7 * 2.0 ** (0.7 * exposure)) for exposure in exposures]
    sky = sky_irradiance(stage)
    if rig.keeps_own_light:
        own = _own_level(scene, stage, {each.name for each in lights}) + ambient * sky
        key = own if own > _BARELY else key
    # the other lights, by their ratios to the key
    factors = {}
    for each in lights:
        subject, around = sheds[each.name]
        edge = each.light.part in ("rim", "kicker") or each.light.reach == "background"
        level = _brightest(around if each.light.reach == "background" else subject, 0.12 if edge else _LIT)
        factor = key * 2.0**each.light.stops / level if level > _BARELY else 0.0
        if edge and each.light.reach != "background":  # on a box, an edge light lights a whole side
            factor *= min(0.2 * level / max(float(subject.mean()), _BARELY), 1.0)
        spots = (
            _hot_spot(stage.subject, factor * subject, _LIT) if each.light.reach == "background" else 0.0,
            _hot_spot(stage.around, factor * around) if each.light.part != "key" else 0.0,
        )
        dimmer = (white / max(spot, _BARELY) for white, spot in zip(whites, spots, strict=True))
        factors[each.name] = factor * min(*dimmer, 1.0)
    # all of them weaker, if subject or surroundings would be overexposed
    world, weaker = 0.0 if rig.world is None else key * 2.0**rig.world, 1.0
    for n, points in enumerate((stage.subject, stage.around)):
        broad = [x for x in lights if not (n and x.light.reach == "background")]  # without hot spots
        base = torch.full((len(points),), world)
        total = sum((factors[x.name] * sheds[x.name][n] for x in broad), base)
        weaker = min(whites[n] / max(_hot_spot(points, total), _BARELY), weaker)
    weaker = max(weaker, 0.35)
    return Levels({name: weaker * factor for name, factor in factors.items()}, weaker * key, sky)


def _own_level(scene: SceneData, stage: LightStage, added: Collection[str]) -> float:
    """Irradiance of the subject's lit side by the scene's own lights: all but those with names in `added`."""
    lamps = [x for x in light_sources(scene, RenderValues(scene, {}, "cpu")) if x.light.name not in added]
    return _brightest(sum((_shed(x, stage, stage.subject) for x in lamps), torch.zeros(len(stage.subject))), _LIT)


def sky_irradiance(stage: LightStage) -> float:
    """Mean irradiance that the subject gets from a world of radiance 1: pi in the open, 0 in a closed room."""
    points: Points = stage.subject
    u, v = sphere_points(_SKY_RAYS, 1, torch.Generator().manual_seed(0))[:, 0]
    up, around = 1 - 2 * u, 2 * math.pi * v
    flat = (1 - up * up).sqrt()
    toward = torch.stack((flat * around.cos(), flat * around.sin(), up))
    total = torch.zeros(len(points))
    for direction in toward.T:
        way = direction[:, None].expand_as(points.position).contiguous()
        total += stage.lit(points, way, torch.full((len(points),), 1e30))
    return float(total.mean()) * 4 * math.pi / _SKY_RAYS if len(points) else math.pi


def _shed(lamp: LightSource, stage: LightStage, points: Points) -> Tensor:
    shed = lamp.irradiance(points.position, points.normal).irradiance
    toward, distance = lamp.toward(points.position)
    clear = stage.clear(points, toward.contiguous(), distance.clamp_max(1e30))
    return shed * clear * float(luminance(lamp.color[None])[0, 0])


def _bounce(stage: LightStage, key: tuple[Tensor, ...]) -> float:
    """The key's light that the walls of a room reflect back, as a multiple of its light on the subject's lit side."""
    lit, every = _brightest(key[0], _LIT), torch.cat(key)
    if lit <= _BARELY or not len(every):
        return 0.0
    albedo = float(torch.cat((stage.subject.albedo, stage.around.albedo)).mean())
    walls = min((1.0 - stage.openness) * albedo, 0.75)  # share of its light that a room reflects back
    return float(every.mean()) / lit * walls / (1.0 - walls)


def _hot_spot(points: Points, light: Tensor, share: float = 0.93) -> float:
    """Radiance below which a share of the points lies, by their irradiance `light` (N,); 0 without points."""
    return float(torch.quantile(points.albedo * light / math.pi, share)) if len(points) else 0.0


def _brightest(light: Tensor, share: float) -> float:
    return float(light.topk(max(int(share * len(light)), 1)).values.mean()) if len(light) else 0.0
