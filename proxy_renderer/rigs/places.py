# SPDX-License-Identifier: Apache-2.0
"""Places of a rig's lights in a scene: those of the scene's own lights, or places from which added lights reach their target.

Candidates around the place that the rig names are tried with rays: what is in the way, how far the walls are, on which side the
subject can be reached. A sun that comes in through a window is looked for over the whole sky.
"""

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from ..render.lights.light_types import LIGHT_TYPES
from ..scene import Light, SceneData
from ..scene.values import RenderValues
from ..schema import orbit
from ..schema.added_lights import PARTS, light_name, role_of
from ..words.lexicon.rigs import RigLight
from ..words.names import plain_name
from .stage import LightStage

BRIGHTNESS = ("light/power", "light/strength")  # families of parameters that set the amount of light
_TURNS = (0.0, -14.0, 14.0, -28.0, 28.0, -45.0, 45.0)
_RISES = (0.0, 12.0, -10.0, 24.0)
_NEARER = (1.0, 0.75, 0.55, 0.4)
_ENOUGH = 0.04  # least mean share of its light with which a light reaches its target
_NEAR = 9.0  # radii from the subject within which a lamp of the scene lights it
_OUTDOORS = 0.78  # openness from which a place has no windows: a cut-away room has 0.75, a walled garden 0.8


@dataclass(frozen=True)
class Placed:
    """A light of the rig in the scene."""

    light: RigLight
    name: str
    type: str
    own: bool  # True for a light that the scene has, False for an added one
    azimuth: float  # with the elevation: degrees, as in `schema.orbit`
    elevation: float
    distance: float  # meters; 0 of a sun
    fixed: bool = False  # whether it must stay where it is: at a lamp, in a window


def placed(lights: Iterable[RigLight], stage: LightStage, add: bool = True, anew: bool = False) -> list[Placed]:
    """The lights of a rig in a scene, the key first, without those that reach nothing.

    Each is a light of the scene (none if `anew`) or, if `add` allows that, an added light.
    """
    found: list[Placed] = []
    turned, present = 1.0, {light.name for light in stage.scene.lights if anew}
    for light in lights:
        # on the key's side, an accent would be a second key
        either = light.mirrored and not (found and light.part == "accent")
        wanted = replace(light, azimuth=turned * light.azimuth, mirrored=either)
        taken = present | {each.name for each in found}
        mine = _own(wanted, stage, taken)
        mine = mine or (_added(wanted, stage, taken, found) if add else None)
        if mine is None:  # the key of the scene, or the light that is called "Rim", wherever it stands
            free = [x for x in _playable(stage, taken) if light.part in ("key", *plain_name(x.name).split())]
            mine = _as_it_stands(wanted, min(free, key=lambda x: x.role != "key"), stage) if free else None
        if mine is None:
            continue
        if not found and light.mirrored and light.azimuth:  # the other lights change sides with the key
            side = _relative(mine.azimuth - stage.front)
            turned = math.copysign(1.0, side * light.azimuth) if abs(side) > 1.0 else 1.0
        found.append(mine)
    return found


def _own(light: RigLight, stage: LightStage, taken: set[str]) -> Placed | None:
    """A light of the scene, not in `taken`, that can be a rig's light by its name, or type and place; None if none."""
    free = _playable(stage, taken)
    if light.worn:  # the bulb in a lamp of the picture
        parts = [*stage.parts_of(light.worn)]
        mine = (x for x in free for m, size in parts if math.dist(x.position, m.tolist()) < size)
        return next((_as_it_stands(light, x, stage) for x in mine if x.type != "SUN"), None)
    said = next((x for x in free if x.name == light.own and not light.pattern), None)
    if said is not None:
        return _as_it_stands(light, said, stage)
    named = [x for x in free if shared_names(light, x)]
    for candidate in (*named, *(x for x in free if _stands_for(x, light, stage))):
        # Mean share of its light with which it reaches the target, where it stands
        points = stage.around if light.reach == "background" else stage.subject
        if candidate.type == "SUN":
            azimuth, elevation = _angles(candidate, stage.scene)
            share = float(stage.sunlit(points, azimuth - stage.front, elevation).mean())
        else:
            lamp = LIGHT_TYPES[candidate.type].of(candidate, stage.scene, RenderValues(stage.scene, {}, "cpu"))
            within = lamp.irradiance(points.position, points.normal).irradiance > 0.0  # a spot's cone
            reached = stage.reached(points, torch.tensor(candidate.position, dtype=torch.float32))
            share = float((reached * within).mean())
        near = (torch.tensor(candidate.position) - stage.middle).norm() < _NEAR * stage.radius
        if share > _ENOUGH and (candidate.type == "SUN" or candidate not in named or bool(near)):
            return _as_it_stands(light, candidate, stage)
    return None


def shared_names(light: RigLight, own: Light) -> set[str]:
    """Words in the names of both a light of the scene and a rig's light: "lamp" of "Floor Lamp", if the rig has a lamp."""
    words = {word.removesuffix("s") for word in plain_name(own.name).split()}
    return words & {word.removesuffix("s") for word in light.names}


def _playable(stage: LightStage, taken: set[str]) -> list[Light]:
    free = {i.owner for i in stage.scene.instances.values() if i.parameter.family in BRIGHTNESS and not i.locked}
    return [x for x in stage.scene.lights if not x.fixed and x.name in free - taken]


def _angles(own: Light, scene: SceneData) -> tuple[float, float]:
    key = f"light/{own.name}/"
    return scene.value(key + "azimuth")[0], scene.value(key + "elevation")[0]


def _as_it_stands(light: RigLight, own: Light, stage: LightStage) -> Placed:
    distance = stage.scene.value(f"light/{own.name}/distance", 0.0)[0]
    return Placed(light, own.name, own.type, True, *_angles(own, stage.scene), distance)


def _stands_for(light: Light, wanted: RigLight, stage: LightStage) -> bool:
    """True if a light of the scene is of the type that a rig wants, and about where the rig wants it."""
    if light.type != wanted.type or wanted.through or wanted.pattern:
        return False
    azimuth, elevation = _angles(light, stage.scene)
    sides = (wanted.azimuth, -wanted.azimuth) if wanted.mirrored else (wanted.azimuth,)
    aside = min(abs(_relative(azimuth - stage.front - side)) for side in sides)
    return aside < 30.0 and abs(elevation - wanted.elevation) < 20.0


def _added(light: RigLight, stage: LightStage, taken: set[str], others: Sequence[Placed]) -> Placed | None:
    """An added light for a rig's light: at a lamp of the scene, as a sun, or where it reaches its target best.

    Lamps where one of the `others` stands are left out. None if there is no place or no free name.
    """
    alone, used = not others, [(other.azimuth, other.elevation, other.distance) for other in others]
    at_lamp = next((place for place in _at_lamps(light, stage) if stage.orbit_of(place) not in used), None)
    if at_lamp is not None:
        name = _free_name(light.part, "POINT", stage, taken)
        return Placed(light, name, "POINT", False, *stage.orbit_of(at_lamp), True) if name else None
    if light.worn:
        return None
    if light.type == "SUN":
        if sun := _sun(light, stage):
            name = light_name("key", "SUN", light.pattern) if light.pattern else ""
            if name in taken or all(light.name != name for light in stage.scene.standby.lights):
                name = _free_name(light.part, "SUN", stage, taken)
            still = bool(light.pattern or (light.through and stage.openness < _OUTDOORS))
            azimuth, elevation = stage.front + sun[0], sun[1]
            return Placed(light, name, "SUN", False, azimuth, elevation, 0.0, still) if name else None
        if not alone and light.part != "key":
            return None
        # a closed room: the window is a soft light from the side
        light = replace(light, type="AREA", distance=2.6, size=1.0, elevation=max(light.elevation, 12.0))
    place, share = _best_place(light, stage)
    name = _free_name(light.part, light.type, stage, taken) if share > _ENOUGH or alone else ""
    return Placed(light, name, light.type, False, *stage.orbit_of(place)) if name else None


def _free_name(part: str, kind: str, stage: LightStage, taken: set[str]) -> str:
    """The name of an added light for a part; if taken, that of another part, of the same role first; "" if all are taken."""
    free = {light.name for light in stage.scene.standby.lights} - taken
    role = role_of(part)
    names = (light_name(each, kind) for each in (part, *sorted(PARTS, key=lambda p: role_of(p) != role)))
    return next((name for name in names if name in free), "")


def _best_place(light: RigLight, stage: LightStage) -> tuple[Tensor, float]:
    """The best place (3,) near the one in the rig, and the mean share of light that reaches the target from there."""
    points = stage.around if light.reach == "background" else stage.subject
    best = (-math.inf, stage.place(light.azimuth, light.elevation, light.distance), 0.0)
    sides = (1.0, -1.0) if light.mirrored and light.azimuth else (1.0,)
    for side, turn, rise, nearer in itertools.product(sides, _TURNS, _RISES, _NEARER):
        elevation = max(min(light.elevation + rise, 88.0), -60.0)
        place = stage.place(side * light.azimuth + turn, elevation, nearer * light.distance)
        share = float(stage.reached(points, place).mean())
        # of another place than the rig's
        cost = abs(turn) / 110.0 + abs(rise) / 80.0 + 0.25 * (1 - nearer) + 0.03 * (side < 0)
        shown = stage.mirrors(place, light.size * stage.radius) > 0.003  # in water or a floor
        score = min(share, 0.5) - 0.3 * cost * max(share, 0.1) - 0.2 * shown
        if share > 0.5 * best[2] and score > best[0]:
            best = score, place, share
        if side > 0 and turn == rise == 0.0 and nearer == 1.0 and share > 0.35 and not shown:
            break  # nothing is in the way
    return best[1], best[2]


def _sun(light: RigLight, stage: LightStage) -> tuple[float, float] | None:
    """(azimuth from the camera, elevation) of the best sun for a rig's light, degrees; None if no sun fits."""
    everywhere = [(float(a), e) for a in range(-180, 180, 12) for e in (8.0, 14.0, 22.0, 32.0, 44.0, 60.0)]
    sides = (1.0, -1.0) if light.mirrored and light.azimuth else (1.0,)
    near = [
        (side * light.azimuth + turn, max(light.elevation + rise, 4.0))
        for side, turn, rise in itertools.product(sides, (0.0, -20.0, 20.0), (0.0, 10.0))
    ]
    # where the rig has it, or, if something is in the way there, over the whole sky
    searches = [(_in_the_open, near), (_in_the_open, everywhere)]
    if light.through and stage.openness < _OUTDOORS:
        searches.insert(0, (_through_window, everywhere))
    for score_of, candidates in searches:
        score, best = max((score_of(light, stage, *each), each) for each in candidates)
        if score > _ENOUGH:
            return best
    return None


def _through_window(light: RigLight, stage: LightStage, azimuth: float, elevation: float) -> float:
    """The score of a sun through a window: 0 if it lights too much or too little, or stands behind the camera."""
    if abs(azimuth) < 50.0:
        return 0.0
    patch, lit = (  # sunlit shares of the surroundings and of the subject
        float((stage.sunlit(points, azimuth, elevation) > 0.03).float().mean())
        for points in (stage.around, stage.subject)
    )
    away = _away(light, azimuth, elevation)
    return min(patch, 0.3) + min(lit, 0.3) - away if 0.03 < patch < 0.5 else 0.0


def _in_the_open(light: RigLight, stage: LightStage, azimuth: float, elevation: float) -> float:
    toward = torch.tensor(orbit.direction(stage.front + azimuth, elevation), dtype=torch.float32)
    facing = float((stage.subject.normal * toward[:, None]).sum(0).clamp_min(0.0).mean())
    lit = float(stage.sunlit(stage.subject, azimuth, elevation).mean())
    clear = lit / max(facing, 1e-3)  # share of what could be lit, which is little from behind
    return 0.5 * lit + 0.5 * clear - _away(light, azimuth, elevation) if clear > 0.4 else 0.0


def _away(light: RigLight, azimuth: float, elevation: float) -> float:
    """The cost of a direction (azimuth from the camera, elevation) by its distance from the rig's, from 0 to 0.25."""
    sides = (light.azimuth, -light.azimuth) if light.mirrored else (light.azimuth,)
    aside = min(abs(_relative(azimuth - side)) for side in sides)
    return 0.125 * (aside / 180.0 + abs(elevation - light.elevation) / 90.0)


def _at_lamps(light: RigLight, stage: LightStage) -> Iterator[Tensor]:
    """Places (3,) of the scene's lamps, flames and signs that can be this light, the nearest to the subject first."""
    words = {word.removesuffix("s") for word in light.names}
    most = 2 * _NEAR * stage.radius
    named = ((m, size) for spoken, m, size in stage.things if spoken & words and size < most)
    lamps = [*(stage.parts_of(light.worn) if light.worn else named)]
    lamps.sort(key=lambda row: float((row[0] - stage.middle).norm()))
    for middle, size in lamps:
        if (middle - stage.middle).norm() > _NEAR * stage.radius:
            continue
        toward, up = stage.middle - middle, torch.tensor([0.0, 0.0, 1.0])
        steps = [up * 0.0, up, toward / toward.norm().clamp_min(1e-6), -up]
        places = [middle + 1.15 * size * step for step in steps]  # a bulb, just outside of the lamp
        reached = [(stage.reached(stage.subject, p), stage.reached(stage.around, p)) for p in places]
        light_at = [float(subject.mean()) + 0.5 * float(around.mean()) for subject, around in reached]
        if max(light_at) > _ENOUGH:
            yield places[light_at.index(max(light_at))]


def _relative(degrees: float) -> float:
    return (degrees + 180.0) % 360.0 - 180.0
