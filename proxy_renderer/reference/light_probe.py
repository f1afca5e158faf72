# SPDX-License-Identifier: Apache-2.0
"""The light of a panorama, such as an HDRI: direction and color of its brightest part, the key, and its ratio to the rest."""

import math
from dataclasses import dataclass

import numpy as np

from ..color.arrays import luminance
from ..schema import Values

_BRIGHT = 6.0  # times the mean luminance; brighter pixels belong to the key
_KEY = 0.1  # least share of all light that a key gives
_NEAR = 4.0  # degrees by which the angles of the scene's key light may differ from the panorama's
_SAME_COLOR = 0.03  # linear; most by which components of colors may differ from the panorama's


@dataclass(frozen=True)
class LightProbe:
    """The light of a panorama, as if it were the world of a scene."""

    azimuth: float | None  # degrees, of the key, as in `schema.orbit`; None if no part stands out
    elevation: float | None  # degrees above the horizon, of the key; None likewise
    key: Values  # color of the key, linear, the greatest component 1; as `around` if no part stands out
    around: Values  # color of the rest, linear, the greatest component 1
    ratio: float  # light of the key on a surface that faces it, in multiples of the rest's light; 0 without a key


def probe(linear: np.ndarray) -> LightProbe:
    """The light of a linear panorama (H, W, 3), equirectangular as in Blender, but with row 0 straight up."""
    height, width = linear.shape[:2]
    up = np.pi / 2 - (np.arange(height) + 0.5) / height * np.pi
    turn = (0.5 - (np.arange(width) + 0.5) / width) * 2 * np.pi
    solid = np.broadcast_to(np.cos(up)[:, None] * (np.pi / height) * (2 * np.pi / width), (height, width))
    light = luminance(linear) * solid
    bright = luminance(linear) > _BRIGHT * light.sum() / solid.sum()

    def color(where: np.ndarray) -> Values:
        total = (linear * solid[..., None])[where].sum(0)
        return tuple((total / max(float(total.max()), 1e-12)).tolist())

    if light[bright].sum() < _KEY * max(light.sum(), 1e-12):
        return LightProbe(None, None, color(~bright), color(~bright), 0.0)
    x, y = np.cos(up)[:, None] * np.cos(turn), np.cos(up)[:, None] * np.sin(turn)
    z = np.broadcast_to(np.sin(up)[:, None], x.shape)
    mean = np.array([(axis * light)[bright].sum() for axis in (x, y, z)])
    azimuth = (math.degrees(math.atan2(mean[1], mean[0])) + 90.0 + 180.0) % 360.0 - 180.0
    elevation = math.degrees(math.asin(mean[2] / np.linalg.norm(mean)))
    fill = np.pi * light[~bright].sum() / solid[~bright].sum()
    ratio = float(np.linalg.norm(mean) / max(fill, 1e-12))
    return LightProbe(azimuth, elevation, color(bright), color(~bright), ratio)


def effects_of(found: LightProbe) -> list[str]:
    """Effects, as text: the scene's key light gets the key's direction and color, the world the color of the rest."""

    def near(parameter: str, value: Values, reach: float) -> str:
        lower, upper = (",".join(f"{v + off:.6g}" for v in value) for off in (-reach, reach))
        return f"{parameter} {lower}..{upper} !0"

    texts = [near("world/color", found.around, _SAME_COLOR), near("key/color", found.key, _SAME_COLOR)]
    texts.append("key/temperature 6499..6501 !0")  # the color says it all
    if found.azimuth is not None and found.elevation is not None:
        texts.append(near("key/azimuth", (found.azimuth,), _NEAR))
        texts.append(near("key/elevation", (found.elevation,), _NEAR))
    return texts


def summary_of(found: LightProbe, name: str) -> str:
    """A sentence on the light of the panorama `name`."""
    if found.azimuth is None or found.elevation is None:
        return f"In {name} light comes from all around: the key light keeps its direction."
    return (
        f"In {name} most light comes from {found.azimuth:.0f}° and {found.elevation:.0f}° up, "
        f"{found.ratio:.1f} times as much as from all around."
    )
