# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes on which gradients are measured, and how far each parameter is moved. No bpy here.

Together they have every parameter of the schema off its bounds, where it changes the picture.
"""

from __future__ import annotations

from dataclasses import dataclass

from vibe_render.core.color import Color
from vibe_render.core.schema_import import schema

from lab.blender.scenes.recipe import CameraRecipe, FinishRecipe, FogRecipe, LightRecipe, SceneRecipe, WorldRecipe

_STEP = 0.05
"""On the perceptual scale, to both sides."""
_MOST = {"deg": 3.0}
"""Angles whose range is whole circles are moved no farther than this."""
_TINTED = (1.0, 0.3, -0.6)
"""A color's components move together in this proportion: its hue and its lightness change."""


@dataclass(frozen=True)
class StepCase:
    """A scene.

    Attributes:
        recipe: What it is made of.
        keys: Patterns of the parameters that are moved in it.
        caption: What it shows, for the encoder.
        prompt: What is asked of it: the objective is that of this vibe.
    """

    recipe: SceneRecipe
    keys: tuple[str, ...]
    caption: str
    prompt: str


_KEY = LightRecipe("AREA", -40.0, 45.0, 0.7, 1.2, (0.9, 0.8, 0.65))
_DUSK = WorldRecipe(0.8, (0.12, 0.15, 0.22))
_ENAMEL = FinishRecipe((0.5, 0.16, 0.08), 0.4, inputs={"Specular Tint": (0.9, 0.7, 0.6), "IOR": 1.6})
_SATIN = FinishRecipe(
    (0.1, 0.3, 0.34),
    0.5,
    inputs={
        "Metallic": 0.4,
        "Coat Weight": 0.5,
        "Coat Roughness": 0.2,
        "Sheen Weight": 0.4,
        "Emission Color": (0.9, 0.5, 0.2),
        "Emission Strength": 0.15,
    },
)
_GLASS = FinishRecipe((0.85, 0.93, 0.9), 0.1, inputs={"Transmission Weight": 0.85, "IOR": 1.45})
_GRADE: dict[str, float | Color] = {
    "exposure": 0.2,
    "gamma": 1.1,
    "grade_exposure": -0.2,
    "lift": (1.03, 1.0, 0.97),
    "midtone": (1.05, 1.0, 0.95),
    "gain": (0.95, 1.0, 1.08),
    "contrast": 1.1,
    "saturation": 1.1,
    "hue": 5.0,
    "grade_gamma": 0.95,
    "vignette": 0.3,
    "glare": 0.2,
}
_WARM_LAMP = {"use_temperature": True, "temperature": 4500.0}

# fmt: off
CASES: tuple[StepCase, ...] = (
    StepCase(SceneRecipe("enamel", "head", (_ENAMEL,), (LightRecipe("AREA", -40.0, 45.0, 0.7, 1.2, (0.9, 0.8, 0.65), settings=_WARM_LAMP),), _DUSK),
         ("camera/*", "light/*", "world/color", "world/strength", "material/Stuff 0/base_color", "material/Stuff 0/roughness", "material/Stuff 0/ior", "material/Stuff 0/specular*", "material/Ground/base_color"),
         "a red enamelled head on a grey floor, soft light from the left", "glossy teal head, cool light from the right, dark background"),
    StepCase(SceneRecipe("satin", "cushion", (_SATIN,), (_KEY,), _DUSK),
         ("material/Stuff 0/metallic", "material/Stuff 0/coat*", "material/Stuff 0/sheen", "material/Stuff 0/emission*"),
         "a teal satin cushion in the evening", "matte red cushion, bright"),
    StepCase(SceneRecipe("glass", "vase", (_GLASS,), (_KEY,), WorldRecipe(0.8, picture="studio"), ground=FinishRecipe((0.6, 0.5, 0.4), 0.6, "checker")),
         ("material/Stuff 0/transmission", "material/Stuff 0/ior"),
         "a glass vase on a chequered floor", "dark green glass, warm light"),
    StepCase(SceneRecipe("globe", "ball", (FinishRecipe((0.8, 0.8, 0.8), 0.35, "map"),), (), WorldRecipe(0.8, picture="sunset")),
         ("world/tint", "world/strength", "world/rotation", "material/Stuff 0/tint", "material/Stuff 0/recolor"),
         "a globe at sunset", "muted globe, very dark"),
    StepCase(SceneRecipe("backdrop", "head", (_ENAMEL,), (_KEY,), WorldRecipe(0.8, (0.12, 0.15, 0.22), backdrop=(0.5, 0.28, 0.14)), stage="none"),
         ("world/*", "material/Stuff 0/base_color", "light/*/power"),
         "a red head before an orange wall", "white head on a dark blue background"),
    StepCase(SceneRecipe("painted", "head", (_ENAMEL,), (_KEY,), WorldRecipe(0.8, (0.12, 0.15, 0.22), backdrop="forest"), stage="none"),
         ("world/*", "material/Stuff 0/base_color", "light/*/power"),
         "a red head in a forest", "green head before a bright, warm background"),
    StepCase(SceneRecipe("mist", "columns", (FinishRecipe((0.45, 0.41, 0.36), 0.8),), (LightRecipe("SUN", 50.0, 40.0, 0.6, 3.0),), WorldRecipe(1.0, (0.3, 0.35, 0.42)), fog=FogRecipe(0.9, (0.75, 0.8, 0.88), 0.2, 0.5, 0.2), view=CameraRecipe(10, 8)),
         ("volume/*",),
         "columns in blue mist", "thick warm fog, high contrast"),
    StepCase(SceneRecipe("point", "head", (_ENAMEL,), (LightRecipe("POINT", 35.0, 40.0, 0.5, 0.3, (0.9, 0.8, 0.6)),), _DUSK),
         ("light/*/power", "light/*/azimuth", "light/*/elevation", "light/*/distance", "light/*/size"),
         "a red head lit from the right", "very dark, bluish light from the left"),
    StepCase(SceneRecipe("sun", "head", (_ENAMEL,), (LightRecipe("SUN", -50.0, 40.0, 0.6, 8.0, (0.9, 0.8, 0.6)),), _DUSK),
         ("light/*/strength", "light/*/azimuth", "light/*/elevation", "light/*/angle"),
         "a red head in low sunlight", "bright, soft light from above"),
    StepCase(SceneRecipe("spot", "head", (_ENAMEL,), (LightRecipe("SPOT", 40.0, 50.0, 0.6, 0.3, (0.9, 0.8, 0.6), settings={"spot_size": 0.6, "spot_blend": 0.5}),), _DUSK),
         ("light/*/power", "light/*/azimuth", "light/*/elevation", "light/*/distance", "light/*/size"),
         "a red head in a spotlight", "hard warm light, dark"),
    StepCase(SceneRecipe("graded", "trio", (FinishRecipe((0.6, 0.06, 0.04), 0.2), FinishRecipe((0.05, 0.2, 0.6), 0.7), FinishRecipe((0.75, 0.55, 0.04), 0.5)), (_KEY,), _DUSK, film=_GRADE),
         ("film/*",),
         "three toys in faded colors", "vintage, muted colors, low contrast, vignette"),
)
# fmt: on


def ends(instance: schema.Instance) -> tuple[schema.Values, schema.Values, schema.Values, float]:
    """Values around an instance's own: low, middle and high, and how far apart the ends are on the perceptual scale.

    The middle is the instance's value, or as near to it as the bounds leave room for a step.
    """
    p = instance.parameter
    weights = _TINTED if p.components == 3 else (1.0,)
    rows = list(zip(instance.value, instance.lower, instance.upper, strict=True))
    units = [p.scale.to_unit(*row) for row in rows]
    middle = [min(max(u, _STEP * abs(w)), 1 - _STEP * abs(w)) for u, w in zip(units, weights, strict=True)]

    def at(step: float) -> schema.Values:
        places = zip(middle, weights, instance.lower, instance.upper, strict=True)
        return tuple(p.scale.from_unit(u + w * step, low, high) for u, w, low, high in places)

    width = max(abs(a - b) / 2 for a, b in zip(at(_STEP), at(-_STEP), strict=True))
    step = _STEP * min(1.0, _MOST.get(p.unit, width) / width)
    return at(-step), at(0.0), at(step), 2 * step
