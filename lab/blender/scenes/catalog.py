# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes that fidelity is measured on: one row each. No bpy here."""

from __future__ import annotations

from vibe_render.core.color import Color

from lab.blender.scenes.recipe import CameraRecipe, FinishRecipe, FogRecipe, LightRecipe, SceneRecipe, WorldRecipe

WARM, COOL = (1.0, 0.78, 0.55), (0.72, 0.84, 1.0)
GOLD, COPPER, STEEL, CHROME = (0.9, 0.62, 0.22), (0.85, 0.42, 0.25), (0.56, 0.57, 0.58), (0.8, 0.8, 0.8)
RED, TEAL, BLUE, GREEN = (0.6, 0.06, 0.04), (0.03, 0.33, 0.35), (0.06, 0.12, 0.45), (0.12, 0.35, 0.08)
CLAY, SAND, BONE, INK = (0.48, 0.24, 0.15), (0.6, 0.46, 0.3), (0.78, 0.74, 0.66), (0.03, 0.03, 0.04)
DIM, DUSK, OVERCAST = (
    WorldRecipe(1.0, (0.05, 0.055, 0.065)),
    WorldRecipe(1.0, (0.12, 0.15, 0.22)),
    WorldRecipe(1.0, (0.5, 0.55, 0.62)),
)
GRAY, WHITE, BOARDS = (
    FinishRecipe((0.42, 0.4, 0.37), 0.7),
    FinishRecipe((0.8, 0.8, 0.8), 0.9),
    FinishRecipe((0.35, 0.2, 0.1), 0.35),
)
GRASS, STONE = FinishRecipe((0.1, 0.16, 0.05), 1.0), FinishRecipe((0.33, 0.31, 0.28), 0.8)


def metal(color: Color, roughness: float) -> FinishRecipe:
    """Bare metal.

    Args:
        roughness: 0 to 1.
    """
    return FinishRecipe(color, roughness, inputs={"Metallic": 1.0})


def coat(color: Color, roughness: float, coat_roughness: float = 0.03, metallic: float = 0.0) -> FinishRecipe:
    """A lacquered material.

    Args:
        color: Of the layer below the lacquer, linear RGB.
        roughness: Of the same layer, 0 to 1.
        coat_roughness: Of the lacquer, 0 to 1.
        metallic: Of the layer below, 0 to 1.
    """
    inputs = {"Coat Weight": 1.0, "Coat Roughness": coat_roughness, "Metallic": metallic}
    return FinishRecipe(color, roughness, inputs=inputs)


def sheen(color: Color, roughness: float = 0.8, weight: float = 1.0) -> FinishRecipe:
    """Velvet or felt.

    Args:
        roughness: Of the material below its fibers, 0 to 1.
        weight: Of the sheen, 0 to 1.
    """
    return FinishRecipe(color, roughness, inputs={"Sheen Weight": weight, "Sheen Roughness": 0.4})


def glow(color: Color, strength: float) -> FinishRecipe:
    """A material that emits light.

    Args:
        color: Of the light, linear RGB.
    """
    return FinishRecipe(INK, 0.5, inputs={"Emission Color": color, "Emission Strength": strength})


def glass(
    color: Color = (0.95, 0.97, 0.96), roughness: float = 0.0, weight: float = 1.0, ior: float = 1.45
) -> FinishRecipe:
    """A material that lets light through.

    Args:
        roughness: 0 to 1.
        weight: Of the transmission, 0 to 1.
    """
    return FinishRecipe(color, roughness, inputs={"Transmission Weight": weight, "IOR": ior})


def key(level: float = 0.8, azimuth: float = -40.0, color: Color = (1.0, 0.96, 0.9), size: float = 1.4) -> LightRecipe:
    """A softbox, 42 degrees up.

    Args:
        level: As in `LightRecipe`, like all arguments.
    """
    return LightRecipe("AREA", azimuth, 42.0, level, size, color)


def rim(level: float = 0.7, azimuth: float = 150.0, color: Color = COOL) -> LightRecipe:
    """A softbox from behind, 35 degrees up.

    Args:
        level: As in `LightRecipe`, like all arguments.
    """
    return LightRecipe("AREA", azimuth, 35.0, level, 1.2, color)


def point(
    azimuth: float,
    level: float,
    color: Color = WARM,
    elevation: float = 30.0,
    distance: float = 3.2,
    size: float = 0.15,
) -> LightRecipe:
    """A bulb.

    Args:
        level: As in `LightRecipe`, like all arguments.
    """
    return LightRecipe("POINT", azimuth, elevation, level, size, color, distance)


def sun(
    azimuth: float, elevation: float, level: float, angle: float = 0.6, color: Color = (1.0, 0.93, 0.82)
) -> LightRecipe:
    """The sun.

    Args:
        level: As in `LightRecipe`, like all arguments.
        angle: Angular diameter, degrees.
    """
    return LightRecipe("SUN", azimuth, elevation, level, angle, color)


def spot(
    azimuth: float,
    level: float,
    opening: float = 0.6,
    blend: float = 0.3,
    color: Color = (1.0, 0.95, 0.88),
    elevation: float = 50.0,
) -> LightRecipe:
    """A theater spot, 6 m away.

    Args:
        level: As in `LightRecipe`.
        opening: Full angle of its cone, radians.
        blend: Softness of the cone's edge, 0 to 1.
    """
    return LightRecipe("SPOT", azimuth, elevation, level, 0.15, color, 6.0, {"spot_size": opening, "spot_blend": blend})


# fmt: off
CATALOG: tuple[SceneRecipe, ...] = (
    # plain surfaces
    SceneRecipe("clay_head", "head", (FinishRecipe(CLAY, 0.8),), (key(),), DIM),
    SceneRecipe("porcelain_vase", "vase", (FinishRecipe(BONE, 0.1),), (key(0.6), point(70, 0.25)), DIM, "cove", transform="Standard"),
    SceneRecipe("red_mirror_ball", "ball", (FinishRecipe(RED, 0.0),), (sun(-50, 45, 0.7),), WorldRecipe(0.6, picture="studio"), ground=GRAY),
    SceneRecipe("high_ior_rings", "rings", (FinishRecipe(BLUE, 0.1, inputs={"IOR": 2.2}), FinishRecipe(GREEN, 0.25, inputs={"IOR": 1.2, "Specular IOR Level": 1.0})), (key(),), OVERCAST, "cove", transform="Filmic"),
    # metals
    SceneRecipe("gold_head", "head", (metal(GOLD, 0.25),), (key(0.4),), WorldRecipe(0.45, picture="interior"), ground=BOARDS),
    SceneRecipe("chrome_ball_checker", "ball", (metal(CHROME, 0.0),), (), WorldRecipe(0.9, picture="courtyard"), ground=FinishRecipe((0.7, 0.68, 0.62), 0.5, "checker"), transform="Standard"),
    SceneRecipe("steel_bolts", "bolts", (metal(STEEL, 0.5), metal(GOLD, 0.25)), (key(0.5), rim(0.5), point(60, 0.4)), DIM, ground=FinishRecipe((0.1, 0.1, 0.11), 0.5), view=CameraRecipe(25, 28)),
    SceneRecipe("copper_rings", "rings", (metal(COPPER, 0.1), metal(STEEL, 0.8), metal(COPPER, 1.0)), (spot(-30, 0.9),), WorldRecipe(0.4, picture="city")),
    SceneRecipe("worn_car", "car", (FinishRecipe(TEAL, 0.5, "worn"), FinishRecipe(INK, 0.5)), (key(0.7), sun(70, 35, 0.4)), DUSK, ground=STONE, view=CameraRecipe(35, 16)),
    # coat and sheen
    SceneRecipe("lacquer_car", "car", (coat(RED, 0.5), coat(RED, 0.5), FinishRecipe(INK, 0.5)), (key(0.4),), WorldRecipe(0.35, picture="city"), ground=GRAY, view=CameraRecipe(-35, 14), transform="Khronos PBR Neutral"),
    SceneRecipe("lacquer_knot", "knot", (coat(BLUE, 0.8, 0.25),), (key(0.7), rim()), DIM, "cove"),
    SceneRecipe("velvet_cushion", "cushion", (sheen((0.2, 0.03, 0.08)),), (key(0.5, -60),), WorldRecipe(0.4, picture="interior"), ground=BOARDS),
    SceneRecipe("velvet_drape", "cloth", (sheen((0.05, 0.12, 0.2), 1.0),), (spot(40, 1.0, 0.8, 0.6),), DIM, ground=GRAY),
    # emission
    SceneRecipe("neon_tubes", "tubes", (glow((0.1, 0.6, 1.0), 6.0), glow((1.0, 0.15, 0.4), 6.0), FinishRecipe((0.3, 0.3, 0.32), 0.25)), (), DIM, ground=FinishRecipe((0.25, 0.25, 0.27), 0.25), film={"glare": 0.5}),
    SceneRecipe("lantern", "lantern", (glow(WARM, 9.0), FinishRecipe((0.2, 0.1, 0.05), 0.5), *(FinishRecipe((0.2, 0.1, 0.05), 0.5),) * 4, metal(COPPER, 0.5)), (point(-60, 0.12, COOL),), WorldRecipe(1.0, (0.015, 0.02, 0.04)), ground=BOARDS, fog=FogRecipe(0.2)),
    # glass
    SceneRecipe("glass_ball", "ball", (glass(),), (sun(50, 40, 0.5),), WorldRecipe(0.8, picture="sunset"), ground=FinishRecipe((0.6, 0.58, 0.54), 0.5, "checker")),
    SceneRecipe("frosted_bottle", "bottle", (glass((0.6, 0.85, 0.75), 0.25),), (key(0.6), rim(0.9)), DUSK, "cove"),
    SceneRecipe("goblet", "goblet", (glass(), FinishRecipe(RED, 0.25)), (key(0.5),), WorldRecipe(0.7, picture="studio"), "cove", transform="Standard"),
    SceneRecipe("jade_crystal", "crystal", (glass((0.2, 0.6, 0.35), 0.5, 0.6),), (point(-40, 0.8), rim(0.5)), DUSK, "cove"),
    # many, thin, large
    SceneRecipe("pebble_heap", "pebbles", (FinishRecipe((0.5, 0.47, 0.43), 1.0), FinishRecipe((0.3, 0.2, 0.15), 0.8), FinishRecipe((0.2, 0.22, 0.25), 0.5)), (sun(-55, 28, 0.8),), WorldRecipe(0.5, picture="sunrise"), ground=FinishRecipe(SAND, 1.0), view=CameraRecipe(20, 24)),
    SceneRecipe("city_blocks", "city", (FinishRecipe((0.6, 0.58, 0.55), 0.8), FinishRecipe((0.3, 0.35, 0.45), 0.25)), (sun(50, 38, 0.9),), DUSK, ground=GRAY, view=CameraRecipe(30, 35, orthographic=True), transform="Filmic"),
    SceneRecipe("garden_chair", "chair", (FinishRecipe((0.65, 0.62, 0.55), 0.5),), (sun(-40, 50, 0.7, 2.0),), WorldRecipe(0.7, picture="forest"), ground=GRASS),
    SceneRecipe("wire_cage", "cage", (metal(STEEL, 0.25), FinishRecipe((0.7, 0.25, 0.03), 0.25)), (key(0.7), spot(120, 0.7, color=COOL)), DIM, "cove"),
    SceneRecipe("pot_plant", "plant", (FinishRecipe(CLAY, 0.8), FinishRecipe(GREEN, 0.5)), (key(0.8, 45),), WorldRecipe(0.5, picture="interior"), "cove", transform="Khronos PBR Neutral"),
    SceneRecipe("bare_tree", "tree", (FinishRecipe((0.12, 0.08, 0.05), 1.0),), (sun(120, 18, 0.9, 1.0, WARM),), WorldRecipe(0.9, picture="sunrise"), ground=GRASS, view=CameraRecipe(10, 5)),
    SceneRecipe("cottage", "house", (FinishRecipe((0.7, 0.66, 0.58), 0.8, "brick"), FinishRecipe((0.35, 0.1, 0.06), 0.8), FinishRecipe((0.3, 0.2, 0.17), 0.8), FinishRecipe((0.06, 0.16, 0.06), 1.0), FinishRecipe((0.06, 0.16, 0.06), 1.0)), (sun(-45, 35, 0.9),), WorldRecipe(0.8, (0.3, 0.45, 0.7)), ground=GRASS, view=CameraRecipe(30, 15), transform="Filmic"),
    SceneRecipe("cornell_box", "trio", (FinishRecipe((0.7, 0.7, 0.7), 0.8), metal(CHROME, 0.1), FinishRecipe((0.7, 0.7, 0.7), 0.25)), (LightRecipe("AREA", 0.0, 85.0, 1.2, 1.2, WARM, 2.6),), WorldRecipe(0.0), "room", FinishRecipe((0.7, 0.69, 0.66), 0.9), view=CameraRecipe(0, 6, 42, 0.62)),
    # textures
    SceneRecipe("globe", "ball", (FinishRecipe((0.8, 0.8, 0.8), 0.25, "map"),), (key(0.7), point(60, 0.2)), WorldRecipe(0.25, picture="interior"), ground=BOARDS, transform="Standard"),
    SceneRecipe("tartan_curtain", "curtain", (FinishRecipe((0.6, 0.1, 0.1), 0.8, "weave"),), (sun(-30, 50, 0.8, 3.0),), OVERCAST, ground=BOARDS),
    SceneRecipe("marble_head", "head", (FinishRecipe((0.8, 0.78, 0.74), 0.25, "marble"),), (key(0.7), rim(0.4)), DUSK, "cove"),
    SceneRecipe("wooden_bowl", "bowl", (FinishRecipe((0.5, 0.26, 0.1), 0.5, "wood"), FinishRecipe(RED, 0.25), FinishRecipe((0.7, 0.5, 0.05), 0.5), FinishRecipe(GREEN, 0.25)), (key(0.6, 40), spot(-70, 0.5)), DIM, ground=FinishRecipe((0.5, 0.5, 0.48), 0.5, "speckles"), view=CameraRecipe(15, 30)),
    SceneRecipe("granite_knot", "knot", (FinishRecipe((0.5, 0.45, 0.42), 0.1, "speckles"),), (key(0.6),), WorldRecipe(0.6, picture="courtyard"), "none"),
    # alpha
    SceneRecipe("ghost_head", "head", (FinishRecipe((0.5, 0.65, 0.8), 0.5, inputs={"Alpha": 0.4}),), (key(0.8), rim(0.6)), DUSK, "cove"),
    SceneRecipe("punched_vase", "vase", (FinishRecipe(TEAL, 0.5, "cut-out"),), (key(0.8),), DUSK, ground=BOARDS),
    SceneRecipe("product_cut_out", "bottle", (coat((0.06, 0.25, 0.12), 0.25),), (key(0.7), rim(0.8)), WorldRecipe(0.6, picture="studio"), "none", transparent=True),
    # fog
    SceneRecipe("columns_haze", "columns", (FinishRecipe((0.45, 0.41, 0.36), 0.8),), (LightRecipe("AREA", 170.0, 25.0, 0.9, 2.0, WARM, 6.0), key(0.3)), WorldRecipe(1.0, (0.14, 0.17, 0.22)), ground=STONE, fog=FogRecipe(0.5, anisotropy=0.3, owner="world"), view=CameraRecipe(8, 7)),
    SceneRecipe("misty_tree", "tree", (FinishRecipe((0.05, 0.04, 0.04), 1.0),), (sun(100, 25, 0.5),), WorldRecipe(1.0, (0.4, 0.45, 0.5)), ground=GRASS, fog=FogRecipe(1.2, (0.75, 0.8, 0.88)), view=CameraRecipe(10, 5)),
    SceneRecipe("thick_morning", "house", (FinishRecipe((0.6, 0.55, 0.48), 0.8), FinishRecipe((0.35, 0.1, 0.06), 0.8)), (sun(-120, 22, 1.3, 1.0, WARM),), WorldRecipe(1.0, (0.35, 0.42, 0.52)), ground=GRASS, fog=FogRecipe(1.1, (0.8, 0.82, 0.85), 0.4), view=CameraRecipe(30, 10)),
    SceneRecipe("graveyard_low_fog", "columns", (FinishRecipe((0.35, 0.34, 0.33), 1.0),), (key(0.5, -60, COOL), point(50, 0.25)), DUSK, ground=GRASS, fog=FogRecipe(1.8, (0.7, 0.78, 0.85), falloff=1.6, offset=0.15), view=CameraRecipe(12, 9)),
    SceneRecipe("stage_spots", "head", (FinishRecipe((0.5, 0.45, 0.42), 0.5),), (spot(-50, 0.8, 0.5, 0.3, WARM), spot(50, 0.8, 0.5, 0.3, COOL), spot(170, 0.9, 0.6)), WorldRecipe(1.0, (0.01, 0.01, 0.015)), ground=FinishRecipe((0.15, 0.14, 0.14), 0.5), fog=FogRecipe(0.3, (0.85, 0.85, 0.85), 0.2), transform="Khronos PBR Neutral"),
    SceneRecipe("blind_shafts", "blind", (FinishRecipe(BONE, 0.5), *(FinishRecipe((0.25, 0.24, 0.23), 0.8),) * 7), (sun(-60, 35, 1.2),), WorldRecipe(1.0, (0.05, 0.06, 0.09)), ground=GRAY, fog=FogRecipe(0.4, (0.8, 0.8, 0.8), 0.3), view=CameraRecipe(35, 12)),
    SceneRecipe("night_street", "house", (FinishRecipe((0.3, 0.3, 0.34), 0.8), metal((0.3, 0.32, 0.36), 0.5), glow(WARM, 3.0), FinishRecipe(GREEN, 1.0)), (point(-50, 0.4), point(50, 0.3, COOL), point(150, 0.4), point(-140, 0.3, COOL)), WorldRecipe(0.25, picture="night"), ground=FinishRecipe((0.12, 0.12, 0.13), 0.25), fog=FogRecipe(0.6, (0.8, 0.8, 0.82)), view=CameraRecipe(25, 12)),
    SceneRecipe("forest_fog", "rock", (FinishRecipe((0.2, 0.19, 0.17), 0.8),), (sun(140, 35, 0.4, 1.0, WARM),), WorldRecipe(0.8, picture="forest"), ground=GRASS, fog=FogRecipe(0.8, (0.75, 0.82, 0.78), 0.2)),
    SceneRecipe("low_ground_mist", "pebbles", (FinishRecipe((0.25, 0.24, 0.23), 0.5), metal(STEEL, 0.25)), (key(0.6),), WorldRecipe(0.5, picture="night"), ground=STONE, fog=FogRecipe(2.5, (0.85, 0.88, 0.9), falloff=3.5), view=CameraRecipe(20, 18)),
    # lights and grades
    SceneRecipe("four_lights", "head", (FinishRecipe((0.6, 0.6, 0.6), 0.5),), (key(0.35, -50, WARM), point(55, 0.3, COOL), spot(100, 0.5, 0.7), sun(-150, 40, 0.4)), WorldRecipe(1.0, (0.02, 0.02, 0.025)), "cove"),
    SceneRecipe("noir", "head", (FinishRecipe((0.5, 0.48, 0.46), 0.25),), (spot(-75, 1.2, 0.5, 0.15), rim(0.3)), WorldRecipe(1.0, (0.01, 0.01, 0.012)), ground=GRAY, film={"contrast": 1.35, "saturation": 0.0, "vignette": 0.6, "exposure": 0.4}),
    SceneRecipe("teal_orange", "car", (coat((0.65, 0.25, 0.04), 0.25), coat((0.65, 0.25, 0.04), 0.25), FinishRecipe(INK, 0.8)), (sun(55, 22, 0.8, 1.0, WARM),), WorldRecipe(0.7, picture="sunset"), ground=STONE, view=CameraRecipe(30, 10), film={"lift": (0.92, 1.0, 1.08), "gain": (1.15, 1.0, 0.88), "saturation": 1.15, "contrast": 1.1}, look="Medium High Contrast"),
    SceneRecipe("faded_film", "plant", (FinishRecipe((0.7, 0.68, 0.62), 0.5), FinishRecipe((0.15, 0.32, 0.12), 0.25)), (sun(-35, 48, 0.6, 2.0),), WorldRecipe(0.8, picture="courtyard"), ground=BOARDS, film={"lift": (1.12, 1.1, 1.08), "contrast": 0.8, "saturation": 0.7, "hue": 6.0, "grade_gamma": 0.9}),
    SceneRecipe("dreamy_glow", "letters", (FinishRecipe((0.7, 0.55, 0.65), 0.25),), (rim(2.5, 140), key(0.7, -50, (1.0, 0.8, 0.85))), WorldRecipe(1.0, (0.25, 0.2, 0.28)), "cove", film={"glare": 0.6, "gamma": 1.15, "midtone": (1.05, 1.0, 1.06), "vignette": 0.3}, transform="Filmic"),
    SceneRecipe("punchy_toys", "trio", (FinishRecipe(RED, 0.1), FinishRecipe((0.05, 0.2, 0.6), 0.8), FinishRecipe((0.75, 0.55, 0.04), 0.5)), (sun(-40, 45, 0.8, 3.0), point(50, 0.3)), WorldRecipe(0.8, (0.5, 0.6, 0.75)), ground=WHITE, look="Punchy", film={"exposure": -0.3}),
)
# fmt: on
