# SPDX-License-Identifier: GPL-3.0-or-later
"""The recipe of a measured scene, as data, and the features that follow from it. No bpy here."""

from __future__ import annotations

import random
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from vibe_render.core.color import Color

ROUGHNESSES = (0.0, 0.1, 0.25, 0.5, 0.8, 1.0)


@dataclass(frozen=True)
class FinishRecipe:
    """A material.

    Attributes:
        color: Base color, linear Rec.709; the seed shifts its hue and lightness a little.
        roughness: As on the Principled BSDF.
        texture: A name in `surfaces.TEXTURES` that colors it; "" for one color.
        inputs: Other sockets of the Principled BSDF, by name.
    """

    color: Color = (0.6, 0.6, 0.6)
    roughness: float = 0.5
    texture: str = ""
    inputs: Mapping[str, float | Color] = field(default_factory=dict)

    def features(self) -> Iterator[str]:
        """The features of the surface."""
        weight = {name: value for name, value in self.inputs.items() if isinstance(value, float)}
        special = {
            "metal": weight.get("Metallic", 0.0) >= 0.5,
            "coat": weight.get("Coat Weight", 0.0) > 0.0,
            "sheen": weight.get("Sheen Weight", 0.0) > 0.0,
            "glass": weight.get("Transmission Weight", 0.0) > 0.0,
            "emission": weight.get("Emission Strength", 0.0) > 0.0,
            "alpha": weight.get("Alpha", 1.0) < 1.0 or self.texture == "cut-out",
        }
        yield from (name for name, is_it in special.items() if is_it)
        if not special["metal"] and not special["glass"]:
            yield "dielectric"
        yield f"roughness {min(ROUGHNESSES, key=lambda r: abs(r - self.roughness)):g}"


@dataclass(frozen=True)
class LightRecipe:
    """A light that shines on the subject.

    Attributes:
        kind: "AREA", "POINT", "SUN" or "SPOT".
        azimuth: Degrees; 0 is in front, 90 on the subject's left-hand side. The seed turns it a little.
        elevation: Degrees above the horizon.
        level: Radiance of a white diffuse surface at the subject that faces it: its brightness in the picture.
        size: Edge, or radius, in meters; of a sun its angle in degrees.
        color: Of its light.
        distance: From the subject, meters.
        settings: Other properties of the light data-block.
    """

    kind: str
    azimuth: float
    elevation: float
    level: float
    size: float = 0.5
    color: Color = (1.0, 1.0, 1.0)
    distance: float = 5.0
    settings: Mapping[str, float | str] = field(default_factory=dict)


@dataclass(frozen=True)
class WorldRecipe:
    """The surroundings: one color, or one of Blender's own environment pictures by name.

    Attributes:
        strength: Of the light.
        color: Of the light.
        picture: Its name; "" for one color.
        backdrop: Color or picture that the camera sees in the light's place; None where it sees the light.
    """

    strength: float = 1.0
    color: Color = (0.05, 0.055, 0.065)
    picture: str = ""
    backdrop: Color | str | None = None


@dataclass(frozen=True)
class FogRecipe:
    """Fog of a vibe, or (`owner` "world") the artist's own in the world.

    Attributes:
        depth: Optical depth from the camera to the subject.
        color: Albedo.
        anisotropy: Of its scattering.
        falloff: 1/m; above 0 it is height fog.
        offset: Height where it starts to thin, meters.
    """

    depth: float
    color: Color = (0.8, 0.84, 0.9)
    anisotropy: float = 0.0
    falloff: float = 0.0
    offset: float = 0.0
    owner: str = "vibe"

    @property
    def feature(self) -> str:
        """Its thickness."""
        if self.falloff > 0.0:
            return "low fog"
        return "thin fog" if self.depth < 0.35 else "medium fog" if self.depth < 1.0 else "thick fog"


@dataclass(frozen=True)
class CameraRecipe:
    """The camera's place and the share of the picture that the subject fills."""

    azimuth: float = 20.0
    elevation: float = 12.0
    fov: float = 38.0
    fill: float = 0.74
    orthographic: bool = False


@dataclass(frozen=True)
class SceneRecipe:
    """A scene.

    Attributes:
        name: Unique; a folder's name.
        shape: The subject, a name in `shapes.SHAPES`, `props.PROPS` or `places.PLACES`.
        finishes: Materials of the subject's parts, in turn.
        stage: "none", "floor", "cove" (a round backdrop) or "room" (three walls).
        ground: Material of the stage.
        walls: Colors of a room's left and right wall.
        film: Film parameters of the schema by name: exposure and the grade.
        transform: View transform of the color management.
        look: Its look, without the transform's name.
        transparent: Whether the film is.
    """

    name: str
    shape: str
    finishes: tuple[FinishRecipe, ...]
    lamps: tuple[LightRecipe, ...] = ()
    world: WorldRecipe = WorldRecipe()
    stage: str = "floor"
    ground: FinishRecipe = FinishRecipe((0.42, 0.4, 0.37), 0.7)
    walls: tuple[Color, Color] = ((0.55, 0.06, 0.05), (0.1, 0.4, 0.08))
    fog: FogRecipe | None = None
    view: CameraRecipe = CameraRecipe()
    film: Mapping[str, float | Color] = field(default_factory=dict)
    transform: str = "AgX"
    look: str = ""
    transparent: bool = False


_GRADE_ONLY = ("exposure", "gamma")


def features(recipe: SceneRecipe, mesh: tuple[str, ...]) -> list[str]:
    """The features of a scene, for the table, derived from its recipe.

    Args:
        recipe: What the scene is made of.
        mesh: What the shape is, from `shapes.SHAPES`.
    """
    names = [*mesh, "no floor" if recipe.stage == "none" else "floor"]
    for finish in recipe.finishes:
        names += finish.features()
    textures = {f.texture for f in (*recipe.finishes, recipe.ground)} - {""}
    names += ["image texture" if t in IMAGES else "procedural texture" for t in sorted(textures)]
    names += [f"{lamp.kind.lower()} light" for lamp in recipe.lamps]
    count = len(recipe.lamps)
    names += [f"{count} light{'' if count == 1 else 's'}", "HDRI world" if recipe.world.picture else "constant world"]
    names += [recipe.fog.feature if recipe.fog else "no fog", recipe.transform]
    names += ["grade"] if set(recipe.film) - set(_GRADE_ONLY) else []
    names += ["transparent film"] if recipe.transparent else []
    return list(dict.fromkeys(names))


IMAGES = ("map", "weave", "crate", "cut-out")
"""Textures that are pictures; the others are node networks."""


def chance(recipe: SceneRecipe, seed: int) -> random.Random:
    """The scene's own random numbers, which depend on nothing but its name and the seed."""
    return random.Random(f"{seed}/{recipe.name}")
