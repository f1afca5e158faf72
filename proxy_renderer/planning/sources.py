# SPDX-License-Identifier: Apache-2.0
"""What ranges are computed from besides the words."""

from __future__ import annotations

from dataclasses import dataclass

from ..prompt.types import SceneDescription
from ..schema import Values

Range = tuple[Values, Values]


@dataclass(frozen=True)
class WorldLook:
    """The world at strength 1.

    Attributes:
        color: Its mean color, linear.
        picture: Mean luminance of its linked picture; 1 for a plain color.
    """

    color: Values = (1.0, 1.0, 1.0)
    picture: float = 1.0


@dataclass(frozen=True)
class Sources:
    """What ranges are computed from besides the effect itself.

    Attributes:
        scene: The scene and its current picture.
        exposure: Stops between the scene's radiance and the view transform, as the artist has them.
        world: What the plan settles on for the world.
        backdrop: The same for what the camera sees of it.
        own_color: sRGB of the color that the material gets or has, for glows.
        key: Radiance, before exposure, of a white surface that faces the key lights; 0 if there are none.
    """

    scene: SceneDescription
    exposure: float = 0.0
    world: WorldLook = WorldLook()
    backdrop: WorldLook = WorldLook()
    own_color: Values = (1.0, 1.0, 1.0)
    key: float = 0.0
