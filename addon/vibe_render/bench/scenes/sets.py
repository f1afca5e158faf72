# SPDX-License-Identifier: GPL-3.0-or-later
"""The sets that the benchmark of the words is played on: none of them shows yet what it will be asked for. No bpy here."""

from __future__ import annotations

from dataclasses import dataclass

from .catalog import (
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
from .recipe import Finish, Fog, Lamp, Recipe, View, World

PLAIN, PALE, DARK = (
    Finish((0.5, 0.5, 0.5), 0.45),
    Finish((0.7, 0.7, 0.68), 0.4),
    Finish((0.12, 0.12, 0.13), 0.5),
)
PLASTER = Finish((0.55, 0.53, 0.5), 0.9)
BEIGE = ((0.5, 0.46, 0.4), (0.5, 0.46, 0.4))
CEILING = Lamp("AREA", 0.0, 85.0, 0.7, 1.4, (1.0, 0.95, 0.88), 2.6)


@dataclass(frozen=True)
class Set:
    """A scene whose materials have names, as an artist's have.

    Attributes:
        recipe: How it is built.
        materials: Names of the subject's materials, in turn.
        ground: Name of the stage's material.
    """

    recipe: Recipe
    materials: tuple[str, ...]
    ground: str = "Floor"


# fmt: off
_SETS = (
    Set(Recipe("duck", "duck", (PLAIN, Finish(CLAY, 0.4), DARK), (key(0.7), rim(0.4)), DIM, "cove", GRAY), ("Duck", "Bill", "Eyes"), "Backdrop"),
    Set(Recipe("mug", "mug", (Finish((0.35, 0.2, 0.12), 0.2),), (key(0.6, 40), point(-60, 0.2)), DUSK, "cove", PLASTER, view=View(-25, 14)), ("Mug",), "Wall"),
    Set(Recipe("rocket", "rocket", (Finish(BONE, 0.6), Finish((0.5, 0.2, 0.12), 0.6)), (key(0.5, 20), point(60, 0.3, COOL)), World(0.3, picture="studio"), "cove", GRAY, view=View(10, 8)), ("Hull", "Fins"), "Backdrop"),
    Set(Recipe("mushroom", "mushroom", (Finish((0.5, 0.12, 0.06), 0.5), Finish(BONE, 0.7)), (sun(-40, 40, 0.8, 2.0),), World(0.5, picture="forest"), "floor", GRASS, view=View(15, 6)), ("Cap", "Stem"), "Moss"),
    Set(Recipe("living_room", "sofa", (Finish((0.42, 0.4, 0.38), 0.8),), (CEILING, point(70, 0.35, distance=2.0)), World(0.3, (0.5, 0.55, 0.6)), "room", BOARDS, walls=BEIGE, view=View(0, 8, 44, 0.62)), ("Sofa",)),
    Set(Recipe("sofa", "sofa", (Finish((0.55, 0.53, 0.5), 0.85),), (key(0.6), key(0.3, 50)), DIM, "cove", PLASTER, view=View(20, 12)), ("Sofa",), "Wall"),
    Set(Recipe("robot", "robot", (metal(STEEL, 0.35), metal((0.7, 0.7, 0.7), 0.25)), (key(0.6), rim(0.5)), World(0.5, picture="courtyard"), "floor", STONE, view=View(25, 10)), ("Shell", "Steel")),
    Set(Recipe("lamp", "lamp", (Finish((0.6, 0.55, 0.45), 0.7), metal((0.6, 0.6, 0.6), 0.3), Finish((0.4, 0.1, 0.08), 0.6), Finish((0.1, 0.2, 0.3), 0.6), Finish(SAND, 0.6)), (key(0.6, 50), point(-60, 0.3)), DUSK, "floor", BOARDS, view=View(20, 14)), ("Shade", "Foot", "Red Book", "Blue Book", "Sand Book"), "Desk"),
    Set(Recipe("boat", "boat", (Finish((0.45, 0.3, 0.2), 0.5), Finish((0.3, 0.2, 0.12), 0.6), PALE), (sun(10, 60, 0.8),), World(0.7, (0.35, 0.5, 0.75)), "floor", Finish((0.25, 0.3, 0.33), 0.3), view=View(15, 7)), ("Hull", "Mast", "Sail"), "Water"),
    Set(Recipe("table", "table", (Finish((0.6, 0.6, 0.58), 0.4), Finish((0.5, 0.48, 0.45), 0.5)), (key(0.6), rim(0.4)), DUSK, "cove", GRAY, view=View(25, 18)), ("Cup", "Table"), "Backdrop"),
    Set(Recipe("donut", "donut", (Finish((0.5, 0.3, 0.15), 0.7), Finish((0.25, 0.12, 0.07), 0.3)), (key(0.6, -55), point(50, 0.3)), DIM, "cove", GRAY, view=View(0, 12)), ("Dough", "Icing"), "Backdrop"),
    Set(Recipe("reading_chair", "chair", (Finish((0.5, 0.32, 0.18), 0.5),), (CEILING,), World(0.4, (0.6, 0.6, 0.58)), "room", PLASTER, walls=BEIGE, view=View(12, 8, 44, 0.6)), ("Chair",)),
    Set(Recipe("cottage", "house", (Finish((0.6, 0.56, 0.48), 0.8), Finish((0.35, 0.12, 0.07), 0.8), Finish((0.3, 0.2, 0.17), 0.8), Finish((0.06, 0.16, 0.06), 1.0), Finish((0.06, 0.16, 0.06), 1.0)), (sun(-45, 40, 0.8),), World(0.8, (0.35, 0.5, 0.75)), "floor", GRASS, view=View(30, 12)), ("Walls", "Roof", "Chimney", "Fir", "Fir Two"), "Meadow"),
    Set(Recipe("temple", "columns", (PLASTER,), (sun(-60, 45, 0.8, 1.0), key(0.2, 40)), World(0.8, (0.45, 0.55, 0.7)), "floor", STONE, view=View(8, 7)), ("Marble",)),
    Set(Recipe("city", "city", (Finish((0.5, 0.48, 0.45), 0.8), Finish((0.3, 0.33, 0.38), 0.4)), (sun(120, 25, 0.4, 8.0, COOL),), World(1.0, (0.3, 0.34, 0.4)), "floor", GRAY, fog=Fog(0.7, (0.7, 0.75, 0.8)), view=View(30, 20)), ("Concrete", "Glass Blocks"), "Street"),
    Set(Recipe("car", "car", (Finish((0.45, 0.45, 0.45), 0.5), Finish((0.45, 0.45, 0.45), 0.5), DARK, DARK, DARK, DARK), (key(0.6), key(0.3, 60), rim(0.5)), DUSK, "cove", GRAY, view=View(35, 12)), ("Body", "Cabin", "Tyre", "Tyre Two", "Tyre Three", "Tyre Four"), "Backdrop"),
    Set(Recipe("head", "head", (Finish(BONE, 0.5),), (key(0.7), rim(0.5)), OVERCAST, "none"), ("Head",)),
    Set(Recipe("vase", "vase", (Finish(CLAY, 0.7),), (key(0.5, 60), point(-30, 0.2)), DIM, "cove", STONE, view=View(0, 8)), ("Vase",), "Backdrop"),
    Set(Recipe("knot", "knot", (PLAIN,), (key(0.6), key(0.4, 50)), World(0.3, picture="interior"), "cove", PLASTER), ("Knot",), "Backdrop"),
    Set(Recipe("balls", "trio", (Finish((0.5, 0.15, 0.1), 0.3), Finish((0.15, 0.3, 0.45), 0.3), PALE), (spot(-40, 1.0), point(60, 0.2)), DIM, "floor", STONE, view=View(15, 12)), ("Red Ball", "Blue Ball", "Pale Ball")),
    Set(Recipe("plant", "plant", (Finish(CLAY, 0.7), Finish((0.1, 0.32, 0.08), 0.5)), (key(0.7, 40),), World(0.5, picture="interior"), "cove", PLASTER), ("Pot", "Leaves"), "Wall"),
    Set(Recipe("letters", "letters", (PALE,), (key(0.6), rim(0.5)), DIM, "cove", GRAY, view=View(10, 8)), ("Letters",), "Backdrop"),
    Set(Recipe("crystal", "crystal", (Finish((0.3, 0.2, 0.35), 0.2),), (spot(-50, 0.8, color=WARM), point(60, 0.4)), World(0.6, (0.25, 0.15, 0.08)), "floor", BOARDS), ("Crystal",)),
    Set(Recipe("cushion", "cushion", (Finish((0.5, 0.45, 0.4), 0.8),), (key(0.6, 40, COOL),), DUSK, "floor", GRAY, film={"vignette": 0.6}), ("Cushion",)),
    Set(Recipe("gallery", "head", (Finish(BONE, 0.6),), (CEILING, key(0.3, -30)), World(0.5, (0.6, 0.6, 0.6)), "room", PALE, walls=((0.7, 0.7, 0.68), (0.7, 0.7, 0.68)), view=View(-5, 6, 42, 0.5)), ("Bust",)),
    Set(Recipe("lantern", "lantern", (PALE, DARK, DARK, DARK, DARK, DARK, Finish((0.3, 0.12, 0.06), 0.5)), (point(-60, 0.25, COOL), rim(0.3)), World(1.0, (0.02, 0.025, 0.05)), "cove", GRAY), ("Bulb", "Base", "Post", "Post Two", "Post Three", "Post Four", "Roof"), "Backdrop"),
    Set(Recipe("bottle", "bottle", (Finish((0.5, 0.5, 0.48), 0.3),), (key(0.6), rim(0.5), point(60, 0.2)), DUSK, "cove", PLASTER, view=View(15, 8)), ("Bottle",), "Backdrop"),
    Set(Recipe("reef", "pebbles", (Finish((0.5, 0.47, 0.43), 0.9), Finish((0.5, 0.3, 0.25), 0.8), Finish((0.35, 0.38, 0.3), 0.6)), (sun(-30, 60, 0.8),), World(0.6, (0.6, 0.65, 0.7)), "floor", Finish(SAND, 1.0), view=View(20, 16)), ("Pale Stone", "Red Stone", "Green Stone"), "Sand"),
    Set(Recipe("breakfast", "mug", (Finish((0.2, 0.3, 0.4), 0.4),), (sun(-60, 25, 0.9, 1.0, WARM), point(50, 0.2)), World(0.5, picture="interior"), "floor", BOARDS, view=View(-20, 20)), ("Mug",), "Table"),
    Set(Recipe("supper", "supper", (PALE, Finish((0.08, 0.15, 0.08), 0.3), WHITE), (key(0.7, 0), key(0.4, -60)), OVERCAST, "floor", BOARDS, view=View(5, 18)), ("Bowl", "Bottle", "Plate"), "Table"),
)
# fmt: on

SETS = {made.recipe.name: made for made in _SETS}
"""By name."""
