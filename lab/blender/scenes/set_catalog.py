# SPDX-License-Identifier: GPL-3.0-or-later
"""Ten sets that fidelity is measured on beside the single subjects: rooms, streets, products, landscapes. No bpy here."""

from __future__ import annotations

from lab.blender.scenes.catalog import (
    BOARDS,
    BONE,
    CLAY,
    COOL,
    DIM,
    GRASS,
    GRAY,
    INK,
    STEEL,
    STONE,
    WARM,
    glass,
    glow,
    key,
    metal,
    point,
    sun,
)
from lab.blender.scenes.recipe import CameraRecipe, FinishRecipe, FogRecipe, SceneRecipe, WorldRecipe
from lab.blender.scenes.sets import BEIGE, CEILING, DARK, PALE, PLASTER

# fmt: off
SET_CATALOG: tuple[SceneRecipe, ...] = (
    SceneRecipe("set_lounge", "lounge", (glow(COOL, 4.0), FinishRecipe((0.4, 0.12, 0.08), 0.9, "weave"), FinishRecipe((0.3, 0.18, 0.1), 0.3), FinishRecipe((0.2, 0.3, 0.35), 0.5), *(FinishRecipe((0.45, 0.42, 0.38), 0.9),) * 8), (CEILING,), WorldRecipe(0.2, (0.5, 0.55, 0.6)), "room", BOARDS, walls=BEIGE, view=CameraRecipe(0, 8, 44, 0.9)),
    SceneRecipe("set_bedroom", "bedroom", (glow(WARM, 8.0), FinishRecipe((0.5, 0.5, 0.55), 0.9), PALE, PALE, *(FinishRecipe((0.3, 0.18, 0.1), 0.4),) * 2), (), WorldRecipe(0.15, COOL), "room", BOARDS, walls=BEIGE, view=CameraRecipe(5, 10, 44, 0.9)),
    SceneRecipe("set_kitchen", "kitchen", (FinishRecipe((0.6, 0.58, 0.54), 0.3, "marble"), FinishRecipe((0.35, 0.2, 0.1), 0.4), FinishRecipe(CLAY, 0.3), metal(STEEL, 0.3)), (CEILING, point(60, 0.3)), DIM, "room", PLASTER, walls=BEIGE, view=CameraRecipe(-5, 8, 44, 0.9)),
    SceneRecipe("set_street", "street", (PLASTER, FinishRecipe((0.45, 0.25, 0.18), 0.8, "brick"), FinishRecipe(BONE, 0.8)), (sun(-60, 38, 0.9),), WorldRecipe(0.8, (0.35, 0.5, 0.75)), "floor", STONE, view=CameraRecipe(0, 10, 50, 0.9)),
    SceneRecipe("set_night_street", "night_street", (FinishRecipe((0.3, 0.28, 0.26), 0.8), FinishRecipe((0.2, 0.2, 0.2), 0.8), glow(WARM, 5.0)), (), WorldRecipe(1.0, (0.01, 0.015, 0.03)), "floor", FinishRecipe((0.1, 0.1, 0.11), 0.25), view=CameraRecipe(0, 10, 50, 0.9)),
    SceneRecipe("set_products", "products", (FinishRecipe((0.1, 0.1, 0.11), 0.35), glass((0.5, 0.8, 0.6)), FinishRecipe((0.5, 0.08, 0.06), 0.15), metal((0.8, 0.6, 0.3), 0.25)), (key(0.7), key(0.3, 60)), DIM, "cove", FinishRecipe((0.3, 0.3, 0.32), 0.3), view=CameraRecipe(10, 10)),
    SceneRecipe("set_boxes", "boxes", (FinishRecipe((0.55, 0.4, 0.25), 0.8), metal(STEEL, 0.3), FinishRecipe(BONE, 0.2)), (key(0.8), point(70, 0.2)), DIM, "cove", GRAY, view=CameraRecipe(15, 18)),
    SceneRecipe("set_valley", "valley", (GRASS, FinishRecipe((0.6, 0.56, 0.48), 0.8), FinishRecipe((0.35, 0.12, 0.07), 0.8)), (sun(-50, 30, 0.9, 1.0, WARM),), WorldRecipe(0.9, (0.35, 0.5, 0.75)), "none", fog=FogRecipe(0.4, (0.7, 0.78, 0.88)), view=CameraRecipe(10, 10, 45, 0.95)),
    SceneRecipe("set_lake", "lake", (FinishRecipe((0.03, 0.06, 0.08), 0.1), GRASS, FinishRecipe((0.3, 0.29, 0.27), 0.8)), (), WorldRecipe(1.0, picture="sunset"), "none", view=CameraRecipe(5, 9, 45, 0.95)),
    SceneRecipe("set_park", "park", (FinishRecipe((0.12, 0.08, 0.05), 1.0), FinishRecipe((0.5, 0.32, 0.18), 0.5), DARK, FinishRecipe(INK, 0.6)), (sun(-40, 45, 0.8, 2.0),), WorldRecipe(0.7, picture="forest"), "floor", GRASS, view=CameraRecipe(15, 8)),
)
# fmt: on
