# SPDX-License-Identifier: Apache-2.0
"""What planning takes and gives: what is known about a scene, and a range for each of its parameters."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..color.constants import Lab
from ..schema import Values
from ..schema.spec import Region
from ..words.lexicon.entries import Effect
from ..words.types import Attribute


@dataclass(frozen=True)
class PictureStats:
    """Measurements of the current picture that plans are made from.

    Attributes:
        lab: "subject"/"surroundings" -> mean display color.
        percentiles: Display lightness L* of the whole picture at 5, 50 and 95 percent.
    """

    lab: dict[Region, Lab] = field(default_factory=dict)
    percentiles: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Glow:
    """A material whose glow lights the scene.

    Attributes:
        light: Radiance that it gives to a white surface at the subject that faces it, if its own is 1.
        azimuth: Direction in which it is seen from the subject, degrees, as in `schema.orbit`.
        objects: Names of the objects that show it.
        color: Mean of what nodes compute, linear, which its emission color then multiplies; white where they do not.
        strength: Mean of what nodes compute, which its emission then multiplies; 1 where they do not.
    """

    light: float
    azimuth: float
    objects: tuple[str, ...] = ()
    color: Values = (1.0, 1.0, 1.0)
    strength: float = 1.0


@dataclass(frozen=True)
class PlanContext:
    """What the planner knows about the scene besides its instances.

    Attributes:
        camera_azimuth: Degrees, as in `schema.orbit`: light directions are relative to it.
        view: View transform: "AgX", "Filmic", "Standard", ...
        light_types: Light -> "POINT", "SPOT", "AREA" or "SUN"; watts mean different things to them.
        added_lights: Lights that the scene lacks and gets because the words ask for them.
        glows: Material -> how it lights the scene, if it glows.
        light_stops: Light -> stops that Blender adds to its power (its `exposure`); none where missing.
        light_elevations: Light -> lowest and highest elevation that floor and ceiling leave it, degrees; any where missing.
        world_share: Fraction of the surroundings' pixels that show the world, not a surface; None if unknown.
        material_share: Material -> fraction of its region's pixels; empty if unknown.
        environment_luminance: Mean luminance of a linked environment at strength 1, untinted.
        backdrop_luminance: The same of a linked backdrop that only the camera sees.
        texture_luminance: Material -> mean luminance of its linked base color.
        values: Current values by key; the artist's where missing.
        picture: Measurements of the picture that these values give; None before the first one.
    """

    camera_azimuth: float = 0.0
    view: str = "AgX"
    light_types: dict[str, str] = field(default_factory=dict)
    added_lights: tuple[str, ...] = ()
    glows: dict[str, Glow] = field(default_factory=dict)
    light_stops: dict[str, float] = field(default_factory=dict)
    light_elevations: dict[str, tuple[float, float]] = field(default_factory=dict)
    world_share: float | None = None
    material_share: dict[str, float] = field(default_factory=dict)
    environment_luminance: float = 0.5
    backdrop_luminance: float = 0.5
    texture_luminance: dict[str, float] = field(default_factory=dict)
    values: dict[str, Values] = field(default_factory=dict)
    picture: PictureStats | None = None


@dataclass(frozen=True)
class PlanEntry:
    """What may happen to one parameter instance.

    Attributes:
        lower: Component-wise, within the instance's hard bounds.
        upper: At least `lower`.
        priority: The smaller the more important; None is never optimized (but still projected).
        reason: For the artist; quotes the word that caused it.
        prior: Weight in [0, 1] of the pull to the artist's value: 0 where words named the value.
        usual: Whether words only have it so as a rule, as nights are blue: it gives way to other words, but not to claims.
        any_hue: Whether a color may take any hue within its range, which is then no box around a named color.
        start: Where the search begins, within the range: the color that words name, well inside of a lamp's sizes. None for
            the artist's value, projected.
    """

    lower: Values
    upper: Values
    priority: int | None
    reason: str
    prior: float = 1.0
    usual: bool = False
    any_hue: bool = False
    start: Values | None = None

    @property
    def is_named(self) -> bool:
        """Whether words name the range."""
        return self.priority is not None and self.prior == 0.0


@dataclass(frozen=True)
class LightPlan:
    """What a lighting rig plans, in the place of the words that it stands for.

    Attributes:
        entries: For every parameter that it sets, by key.
        served: The words that it stands for; they ask for nothing else.
        grade: What belongs to it of the film: effects, with the word that asks for them.
    """

    entries: dict[str, PlanEntry] = field(default_factory=dict)
    served: tuple[Attribute, ...] = ()
    grade: tuple[tuple[Attribute, Effect], ...] = ()


class Plan(dict[str, PlanEntry]):
    """An entry for every instance of the scene, by key.

    Attributes:
        notes: Contradictions resolved and bounds that stood in the way, one sentence each.
    """

    def __init__(self, entries: dict[str, PlanEntry] | None = None, notes: tuple[str, ...] = ()) -> None:
        super().__init__(entries or {})
        self.notes = notes
