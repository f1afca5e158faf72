# SPDX-License-Identifier: GPL-3.0-or-later
"""The sets of the paper's benchmark; none shows yet the look that will be asked for. No bpy here."""

from __future__ import annotations

from dataclasses import dataclass

from lab.blender.scenes.catalog import (
    BOARDS,
    BONE,
    CLAY,
    COOL,
    DIM,
    DUSK,
    GRASS,
    GRAY,
    OVERCAST,
    SAND,
    STEEL,
    STONE,
    WARM,
    WHITE,
    key,
    metal,
    point,
    rim,
    spot,
    sun,
)
from lab.blender.scenes.recipe import CameraRecipe, FinishRecipe, FogRecipe, LightRecipe, SceneRecipe, WorldRecipe

PLAIN, PALE, DARK = (
    FinishRecipe((0.5, 0.5, 0.5), 0.45),
    FinishRecipe((0.7, 0.7, 0.68), 0.4),
    FinishRecipe((0.12, 0.12, 0.13), 0.5),
)
PLASTER = FinishRecipe((0.55, 0.53, 0.5), 0.9)
BEIGE = ((0.5, 0.46, 0.4), (0.5, 0.46, 0.4))
CEILING = LightRecipe("AREA", 0.0, 85.0, 0.7, 1.4, (1.0, 0.95, 0.88), 2.6)


@dataclass(frozen=True)
class PaperSet:
    """A scene whose materials have names, as an artist's have.

    Attributes:
        recipe: How it is built.
        materials: Names of the subject's materials, in turn.
        ground: Name of the stage's material.
    """

    recipe: SceneRecipe
    materials: tuple[str, ...]
    ground: str = "Floor"


# fmt: off
_SETS = (
    PaperSet(SceneRecipe("duck", "duck", (PLAIN, FinishRecipe(CLAY, 0.4), DARK), (key(0.7), rim(0.4)), DIM, "cove", GRAY), ("Duck", "Bill", "Eyes"), "Backdrop"),
    PaperSet(SceneRecipe("mug", "mug", (FinishRecipe((0.35, 0.2, 0.12), 0.2),), (key(0.6, 40), point(-60, 0.2)), DUSK, "cove", PLASTER, view=CameraRecipe(-25, 14)), ("Mug",), "Wall"),
    PaperSet(SceneRecipe("rocket", "rocket", (FinishRecipe(BONE, 0.6), FinishRecipe((0.5, 0.2, 0.12), 0.6)), (key(0.5, 20), point(60, 0.3, COOL)), WorldRecipe(0.3, picture="studio"), "cove", GRAY, view=CameraRecipe(10, 8)), ("Hull", "Fins"), "Backdrop"),
    PaperSet(SceneRecipe("mushroom", "mushroom", (FinishRecipe((0.5, 0.12, 0.06), 0.5), FinishRecipe(BONE, 0.7)), (sun(-40, 40, 0.8, 2.0),), WorldRecipe(0.5, picture="forest"), "floor", GRASS, view=CameraRecipe(15, 6)), ("Cap", "Stem"), "Moss"),
    PaperSet(SceneRecipe("living_room", "sofa", (FinishRecipe((0.42, 0.4, 0.38), 0.8),), (CEILING, point(70, 0.35, distance=2.0)), WorldRecipe(0.3, (0.5, 0.55, 0.6)), "room", BOARDS, walls=BEIGE, view=CameraRecipe(0, 8, 44, 0.62)), ("Sofa",)),
    PaperSet(SceneRecipe("sofa", "sofa", (FinishRecipe((0.55, 0.53, 0.5), 0.85),), (key(0.6), key(0.3, 50)), DIM, "cove", PLASTER, view=CameraRecipe(20, 12)), ("Sofa",), "Wall"),
    PaperSet(SceneRecipe("robot", "robot", (metal(STEEL, 0.35), metal((0.7, 0.7, 0.7), 0.25)), (key(0.6), rim(0.5)), WorldRecipe(0.5, picture="courtyard"), "floor", STONE, view=CameraRecipe(25, 10)), ("Shell", "Steel")),
    PaperSet(SceneRecipe("lamp", "lamp", (FinishRecipe((0.6, 0.55, 0.45), 0.7), metal((0.6, 0.6, 0.6), 0.3), FinishRecipe((0.4, 0.1, 0.08), 0.6), FinishRecipe((0.1, 0.2, 0.3), 0.6), FinishRecipe(SAND, 0.6)), (key(0.6, 50), point(-60, 0.3)), DUSK, "floor", BOARDS, view=CameraRecipe(20, 14)), ("Shade", "Foot", "Red Book", "Blue Book", "Sand Book"), "Desk"),
    PaperSet(SceneRecipe("boat", "boat", (FinishRecipe((0.45, 0.3, 0.2), 0.5), FinishRecipe((0.3, 0.2, 0.12), 0.6), PALE), (sun(10, 60, 0.8),), WorldRecipe(0.7, (0.35, 0.5, 0.75)), "floor", FinishRecipe((0.25, 0.3, 0.33), 0.3), view=CameraRecipe(15, 7)), ("Hull", "Mast", "Sail"), "Water"),
    PaperSet(SceneRecipe("table", "table", (FinishRecipe((0.6, 0.6, 0.58), 0.4), FinishRecipe((0.5, 0.48, 0.45), 0.5)), (key(0.6), rim(0.4)), DUSK, "cove", GRAY, view=CameraRecipe(25, 18)), ("Cup", "Table"), "Backdrop"),
    PaperSet(SceneRecipe("donut", "donut", (FinishRecipe((0.5, 0.3, 0.15), 0.7), FinishRecipe((0.25, 0.12, 0.07), 0.3)), (key(0.6, -55), point(50, 0.3)), DIM, "cove", GRAY, view=CameraRecipe(0, 12)), ("Dough", "Icing"), "Backdrop"),
    PaperSet(SceneRecipe("reading_chair", "chair", (FinishRecipe((0.5, 0.32, 0.18), 0.5),), (CEILING,), WorldRecipe(0.4, (0.6, 0.6, 0.58)), "room", PLASTER, walls=BEIGE, view=CameraRecipe(12, 8, 44, 0.6)), ("Chair",)),
    PaperSet(SceneRecipe("cottage", "house", (FinishRecipe((0.6, 0.56, 0.48), 0.8), FinishRecipe((0.35, 0.12, 0.07), 0.8), FinishRecipe((0.3, 0.2, 0.17), 0.8), FinishRecipe((0.06, 0.16, 0.06), 1.0), FinishRecipe((0.06, 0.16, 0.06), 1.0)), (sun(-45, 40, 0.8),), WorldRecipe(0.8, (0.35, 0.5, 0.75)), "floor", GRASS, view=CameraRecipe(30, 12)), ("Walls", "Roof", "Chimney", "Fir", "Fir Two"), "Meadow"),
    PaperSet(SceneRecipe("temple", "columns", (PLASTER,), (sun(-60, 45, 0.8, 1.0), key(0.2, 40)), WorldRecipe(0.8, (0.45, 0.55, 0.7)), "floor", STONE, view=CameraRecipe(8, 7)), ("Marble",)),
    PaperSet(SceneRecipe("city", "city", (FinishRecipe((0.5, 0.48, 0.45), 0.8), FinishRecipe((0.3, 0.33, 0.38), 0.4)), (sun(120, 25, 0.4, 8.0, COOL),), WorldRecipe(1.0, (0.3, 0.34, 0.4)), "floor", GRAY, fog=FogRecipe(0.7, (0.7, 0.75, 0.8)), view=CameraRecipe(30, 20)), ("Concrete", "Glass Blocks"), "Street"),
    PaperSet(SceneRecipe("car", "car", (FinishRecipe((0.45, 0.45, 0.45), 0.5), FinishRecipe((0.45, 0.45, 0.45), 0.5), DARK, DARK, DARK, DARK), (key(0.6), key(0.3, 60), rim(0.5)), DUSK, "cove", GRAY, view=CameraRecipe(35, 12)), ("Body", "Cabin", "Tyre", "Tyre Two", "Tyre Three", "Tyre Four"), "Backdrop"),
    PaperSet(SceneRecipe("head", "head", (FinishRecipe(BONE, 0.5),), (key(0.7), rim(0.5)), OVERCAST, "none"), ("Head",)),
    PaperSet(SceneRecipe("vase", "vase", (FinishRecipe(CLAY, 0.7),), (key(0.5, 60), point(-30, 0.2)), DIM, "cove", STONE, view=CameraRecipe(0, 8)), ("Vase",), "Backdrop"),
    PaperSet(SceneRecipe("knot", "knot", (PLAIN,), (key(0.6), key(0.4, 50)), WorldRecipe(0.3, picture="interior"), "cove", PLASTER), ("Knot",), "Backdrop"),
    PaperSet(SceneRecipe("balls", "trio", (FinishRecipe((0.5, 0.15, 0.1), 0.3), FinishRecipe((0.15, 0.3, 0.45), 0.3), PALE), (spot(-40, 1.0), point(60, 0.2)), DIM, "floor", STONE, view=CameraRecipe(15, 12)), ("Red Ball", "Blue Ball", "Pale Ball")),
    PaperSet(SceneRecipe("plant", "plant", (FinishRecipe(CLAY, 0.7), FinishRecipe((0.1, 0.32, 0.08), 0.5)), (key(0.7, 40),), WorldRecipe(0.5, picture="interior"), "cove", PLASTER), ("Pot", "Leaves"), "Wall"),
    PaperSet(SceneRecipe("letters", "letters", (PALE,), (key(0.6), rim(0.5)), DIM, "cove", GRAY, view=CameraRecipe(10, 8)), ("Letters",), "Backdrop"),
    PaperSet(SceneRecipe("crystal", "crystal", (FinishRecipe((0.3, 0.2, 0.35), 0.2),), (spot(-50, 0.8, color=WARM), point(60, 0.4)), WorldRecipe(0.6, (0.25, 0.15, 0.08)), "floor", BOARDS), ("Crystal",)),
    PaperSet(SceneRecipe("cushion", "cushion", (FinishRecipe((0.5, 0.45, 0.4), 0.8),), (key(0.6, 40, COOL),), DUSK, "floor", GRAY, film={"vignette": 0.6}), ("Cushion",)),
    PaperSet(SceneRecipe("gallery", "head", (FinishRecipe(BONE, 0.6),), (CEILING, key(0.3, -30)), WorldRecipe(0.5, (0.6, 0.6, 0.6)), "room", PALE, walls=((0.7, 0.7, 0.68), (0.7, 0.7, 0.68)), view=CameraRecipe(-5, 6, 42, 0.5)), ("Bust",)),
    PaperSet(SceneRecipe("lantern", "lantern", (PALE, DARK, DARK, DARK, DARK, DARK, FinishRecipe((0.3, 0.12, 0.06), 0.5)), (point(-60, 0.25, COOL), rim(0.3)), WorldRecipe(1.0, (0.02, 0.025, 0.05)), "cove", GRAY), ("Bulb", "Base", "Post", "Post Two", "Post Three", "Post Four", "Roof"), "Backdrop"),
    PaperSet(SceneRecipe("bottle", "bottle", (FinishRecipe((0.5, 0.5, 0.48), 0.3),), (key(0.6), rim(0.5), point(60, 0.2)), DUSK, "cove", PLASTER, view=CameraRecipe(15, 8)), ("Bottle",), "Backdrop"),
    PaperSet(SceneRecipe("reef", "pebbles", (FinishRecipe((0.5, 0.47, 0.43), 0.9), FinishRecipe((0.5, 0.3, 0.25), 0.8), FinishRecipe((0.35, 0.38, 0.3), 0.6)), (sun(-30, 60, 0.8),), WorldRecipe(0.6, (0.6, 0.65, 0.7)), "floor", FinishRecipe(SAND, 1.0), view=CameraRecipe(20, 16)), ("Pale Stone", "Red Stone", "Green Stone"), "Sand"),
    PaperSet(SceneRecipe("breakfast", "mug", (FinishRecipe((0.2, 0.3, 0.4), 0.4),), (sun(-60, 25, 0.9, 1.0, WARM), point(50, 0.2)), WorldRecipe(0.5, picture="interior"), "floor", BOARDS, view=CameraRecipe(-20, 20)), ("Mug",), "Table"),
    PaperSet(SceneRecipe("supper", "supper", (PALE, FinishRecipe((0.08, 0.15, 0.08), 0.3), WHITE), (key(0.7, 0), key(0.4, -60)), OVERCAST, "floor", BOARDS, view=CameraRecipe(5, 18)), ("Bowl", "Bottle", "Plate"), "Table"),
)
# fmt: on

SETS = {each.recipe.name: each for each in _SETS}
"""By name."""
