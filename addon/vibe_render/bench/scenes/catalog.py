# SPDX-License-Identifier: GPL-3.0-or-later
"""The scenes that fidelity is measured on: one row each. No bpy here."""

from __future__ import annotations

from .recipe import Color, Finish, Fog, Lamp, Recipe, View, World

WARM, COOL = (1.0, 0.78, 0.55), (0.72, 0.84, 1.0)
GOLD, COPPER, STEEL, CHROME = (0.9, 0.62, 0.22), (0.85, 0.42, 0.25), (0.56, 0.57, 0.58), (0.8, 0.8, 0.8)
RED, TEAL, BLUE, GREEN = (0.6, 0.06, 0.04), (0.03, 0.33, 0.35), (0.06, 0.12, 0.45), (0.12, 0.35, 0.08)
CLAY, SAND, BONE, INK = (0.48, 0.24, 0.15), (0.6, 0.46, 0.3), (0.78, 0.74, 0.66), (0.03, 0.03, 0.04)
DIM, DUSK, OVERCAST = (
    World(1.0, (0.05, 0.055, 0.065)),
    World(1.0, (0.12, 0.15, 0.22)),
    World(1.0, (0.5, 0.55, 0.62)),
)
GRAY, WHITE, BOARDS = (
    Finish((0.42, 0.4, 0.37), 0.7),
    Finish((0.8, 0.8, 0.8), 0.9),
    Finish((0.35, 0.2, 0.1), 0.35),
)
GRASS, STONE = Finish((0.1, 0.16, 0.05), 1.0), Finish((0.33, 0.31, 0.28), 0.8)


def metal(color: Color, roughness: float) -> Finish:
    """Bare metal."""
    return Finish(color, roughness, inputs={"Metallic": 1.0})


def coat(color: Color, roughness: float, coat_roughness: float = 0.03, metallic: float = 0.0) -> Finish:
    """Lacquered."""
    inputs = {"Coat Weight": 1.0, "Coat Roughness": coat_roughness, "Metallic": metallic}
    return Finish(color, roughness, inputs=inputs)


def sheen(color: Color, roughness: float = 0.8, weight: float = 1.0) -> Finish:
    """Velvet, felt."""
    return Finish(color, roughness, inputs={"Sheen Weight": weight, "Sheen Roughness": 0.4})


def glow(color: Color, strength: float) -> Finish:
    """Emits light."""
    return Finish(INK, 0.5, inputs={"Emission Color": color, "Emission Strength": strength})


def glass(
    color: Color = (0.95, 0.97, 0.96), roughness: float = 0.0, weight: float = 1.0, ior: float = 1.45
) -> Finish:
    """Lets light through."""
    return Finish(color, roughness, inputs={"Transmission Weight": weight, "IOR": ior})


def key(
    level: float = 0.8, azimuth: float = -40.0, color: Color = (1.0, 0.96, 0.9), size: float = 1.4
) -> Lamp:
    """A softbox."""
    return Lamp("AREA", azimuth, 42.0, level, size, color)


def rim(level: float = 0.7, azimuth: float = 150.0, color: Color = COOL) -> Lamp:
    """A softbox from behind."""
    return Lamp("AREA", azimuth, 35.0, level, 1.2, color)


def point(
    azimuth: float,
    level: float,
    color: Color = WARM,
    elevation: float = 30.0,
    distance: float = 3.2,
    size: float = 0.15,
) -> Lamp:
    """A bulb."""
    return Lamp("POINT", azimuth, elevation, level, size, color, distance)


def sun(
    azimuth: float, elevation: float, level: float, angle: float = 0.6, color: Color = (1.0, 0.93, 0.82)
) -> Lamp:
    """The sun."""
    return Lamp("SUN", azimuth, elevation, level, angle, color)


def spot(
    azimuth: float,
    level: float,
    opening: float = 0.6,
    blend: float = 0.3,
    color: Color = (1.0, 0.95, 0.88),
    elevation: float = 50.0,
) -> Lamp:
    """A theatre spot; its opening angle in radians."""
    return Lamp(
        "SPOT", azimuth, elevation, level, 0.15, color, 6.0, {"spot_size": opening, "spot_blend": blend}
    )


# fmt: off
CATALOG: tuple[Recipe, ...] = (
    # plain surfaces
    Recipe("clay_head", "head", (Finish(CLAY, 0.8),), (key(),), DIM),
    Recipe("porcelain_vase", "vase", (Finish(BONE, 0.1),), (key(0.6), point(70, 0.25)), DIM, "cove", transform="Standard"),
    Recipe("red_mirror_ball", "ball", (Finish(RED, 0.0),), (sun(-50, 45, 0.7),), World(0.6, picture="studio"), ground=GRAY),
    Recipe("high_ior_rings", "rings", (Finish(BLUE, 0.1, inputs={"IOR": 2.2}), Finish(GREEN, 0.25, inputs={"IOR": 1.2, "Specular IOR Level": 1.0})), (key(),), OVERCAST, "cove", transform="Filmic"),
    # metals
    Recipe("gold_head", "head", (metal(GOLD, 0.25),), (key(0.4),), World(0.45, picture="interior"), ground=BOARDS),
    Recipe("chrome_ball_checker", "ball", (metal(CHROME, 0.0),), (), World(0.9, picture="courtyard"), ground=Finish((0.7, 0.68, 0.62), 0.5, "checker"), transform="Standard"),
    Recipe("steel_bolts", "bolts", (metal(STEEL, 0.5), metal(GOLD, 0.25)), (key(0.5), rim(0.5), point(60, 0.4)), DIM, ground=Finish((0.1, 0.1, 0.11), 0.5), view=View(25, 28)),
    Recipe("copper_rings", "rings", (metal(COPPER, 0.1), metal(STEEL, 0.8), metal(COPPER, 1.0)), (spot(-30, 0.9),), World(0.4, picture="city")),
    Recipe("worn_car", "car", (Finish(TEAL, 0.5, "worn"), Finish(INK, 0.5)), (key(0.7), sun(70, 35, 0.4)), DUSK, ground=STONE, view=View(35, 16)),
    # coat and sheen
    Recipe("lacquer_car", "car", (coat(RED, 0.5), coat(RED, 0.5), Finish(INK, 0.5)), (key(0.4),), World(0.35, picture="city"), ground=GRAY, view=View(-35, 14), transform="Khronos PBR Neutral"),
    Recipe("lacquer_knot", "knot", (coat(BLUE, 0.8, 0.25),), (key(0.7), rim()), DIM, "cove"),
    Recipe("velvet_cushion", "cushion", (sheen((0.2, 0.03, 0.08)),), (key(0.5, -60),), World(0.4, picture="interior"), ground=BOARDS),
    Recipe("velvet_drape", "cloth", (sheen((0.05, 0.12, 0.2), 1.0),), (spot(40, 1.0, 0.8, 0.6),), DIM, ground=GRAY),
    # emission
    Recipe("neon_tubes", "tubes", (glow((0.1, 0.6, 1.0), 6.0), glow((1.0, 0.15, 0.4), 6.0), Finish((0.3, 0.3, 0.32), 0.25)), (), DIM, ground=Finish((0.25, 0.25, 0.27), 0.25), film={"glare": 0.5}),
    Recipe("lantern", "lantern", (glow(WARM, 9.0), Finish((0.2, 0.1, 0.05), 0.5), *(Finish((0.2, 0.1, 0.05), 0.5),) * 4, metal(COPPER, 0.5)), (point(-60, 0.12, COOL),), World(1.0, (0.015, 0.02, 0.04)), ground=BOARDS, fog=Fog(0.2)),
    # glass
    Recipe("glass_ball", "ball", (glass(),), (sun(50, 40, 0.5),), World(0.8, picture="sunset"), ground=Finish((0.6, 0.58, 0.54), 0.5, "checker")),
    Recipe("frosted_bottle", "bottle", (glass((0.6, 0.85, 0.75), 0.25),), (key(0.6), rim(0.9)), DUSK, "cove"),
    Recipe("goblet", "goblet", (glass(), Finish(RED, 0.25)), (key(0.5),), World(0.7, picture="studio"), "cove", transform="Standard"),
    Recipe("jade_crystal", "crystal", (glass((0.2, 0.6, 0.35), 0.5, 0.6),), (point(-40, 0.8), rim(0.5)), DUSK, "cove"),
    # many, thin, large
    Recipe("pebble_heap", "pebbles", (Finish((0.5, 0.47, 0.43), 1.0), Finish((0.3, 0.2, 0.15), 0.8), Finish((0.2, 0.22, 0.25), 0.5)), (sun(-55, 28, 0.8),), World(0.5, picture="sunrise"), ground=Finish(SAND, 1.0), view=View(20, 24)),
    Recipe("city_blocks", "city", (Finish((0.6, 0.58, 0.55), 0.8), Finish((0.3, 0.35, 0.45), 0.25)), (sun(50, 38, 0.9),), DUSK, ground=GRAY, view=View(30, 35, orthographic=True), transform="Filmic"),
    Recipe("garden_chair", "chair", (Finish((0.65, 0.62, 0.55), 0.5),), (sun(-40, 50, 0.7, 2.0),), World(0.7, picture="forest"), ground=GRASS),
    Recipe("wire_cage", "cage", (metal(STEEL, 0.25), Finish((0.7, 0.25, 0.03), 0.25)), (key(0.7), spot(120, 0.7, color=COOL)), DIM, "cove"),
    Recipe("pot_plant", "plant", (Finish(CLAY, 0.8), Finish(GREEN, 0.5)), (key(0.8, 45),), World(0.5, picture="interior"), "cove", transform="Khronos PBR Neutral"),
    Recipe("bare_tree", "tree", (Finish((0.12, 0.08, 0.05), 1.0),), (sun(120, 18, 0.9, 1.0, WARM),), World(0.9, picture="sunrise"), ground=GRASS, view=View(10, 5)),
    Recipe("cottage", "house", (Finish((0.7, 0.66, 0.58), 0.8, "brick"), Finish((0.35, 0.1, 0.06), 0.8), Finish((0.3, 0.2, 0.17), 0.8), Finish((0.06, 0.16, 0.06), 1.0), Finish((0.06, 0.16, 0.06), 1.0)), (sun(-45, 35, 0.9),), World(0.8, (0.3, 0.45, 0.7)), ground=GRASS, view=View(30, 15), transform="Filmic"),
    Recipe("cornell_box", "trio", (Finish((0.7, 0.7, 0.7), 0.8), metal(CHROME, 0.1), Finish((0.7, 0.7, 0.7), 0.25)), (Lamp("AREA", 0.0, 85.0, 1.2, 1.2, WARM, 2.6),), World(0.0), "room", Finish((0.7, 0.69, 0.66), 0.9), view=View(0, 6, 42, 0.62)),
    # textures
    Recipe("globe", "ball", (Finish((0.8, 0.8, 0.8), 0.25, "map"),), (key(0.7), point(60, 0.2)), World(0.25, picture="interior"), ground=BOARDS, transform="Standard"),
    Recipe("tartan_curtain", "curtain", (Finish((0.6, 0.1, 0.1), 0.8, "weave"),), (sun(-30, 50, 0.8, 3.0),), OVERCAST, ground=BOARDS),
    Recipe("marble_head", "head", (Finish((0.8, 0.78, 0.74), 0.25, "marble"),), (key(0.7), rim(0.4)), DUSK, "cove"),
    Recipe("wooden_bowl", "bowl", (Finish((0.5, 0.26, 0.1), 0.5, "wood"), Finish(RED, 0.25), Finish((0.7, 0.5, 0.05), 0.5), Finish(GREEN, 0.25)), (key(0.6, 40), spot(-70, 0.5)), DIM, ground=Finish((0.5, 0.5, 0.48), 0.5, "speckles"), view=View(15, 30)),
    Recipe("granite_knot", "knot", (Finish((0.5, 0.45, 0.42), 0.1, "speckles"),), (key(0.6),), World(0.6, picture="courtyard"), "none"),
    # alpha
    Recipe("ghost_head", "head", (Finish((0.5, 0.65, 0.8), 0.5, inputs={"Alpha": 0.4}),), (key(0.8), rim(0.6)), DUSK, "cove"),
    Recipe("punched_vase", "vase", (Finish(TEAL, 0.5, "cut-out"),), (key(0.8),), DUSK, ground=BOARDS),
    Recipe("product_cut_out", "bottle", (coat((0.06, 0.25, 0.12), 0.25),), (key(0.7), rim(0.8)), World(0.6, picture="studio"), "none", transparent=True),
    # fog
    Recipe("columns_haze", "columns", (Finish((0.45, 0.41, 0.36), 0.8),), (Lamp("AREA", 170.0, 25.0, 0.9, 2.0, WARM, 6.0), key(0.3)), World(1.0, (0.14, 0.17, 0.22)), ground=STONE, fog=Fog(0.5, anisotropy=0.3, owner="world"), view=View(8, 7)),
    Recipe("misty_tree", "tree", (Finish((0.05, 0.04, 0.04), 1.0),), (sun(100, 25, 0.5),), World(1.0, (0.4, 0.45, 0.5)), ground=GRASS, fog=Fog(1.2, (0.75, 0.8, 0.88)), view=View(10, 5)),
    Recipe("thick_morning", "house", (Finish((0.6, 0.55, 0.48), 0.8), Finish((0.35, 0.1, 0.06), 0.8)), (sun(-120, 22, 1.3, 1.0, WARM),), World(1.0, (0.35, 0.42, 0.52)), ground=GRASS, fog=Fog(1.1, (0.8, 0.82, 0.85), 0.4), view=View(30, 10)),
    Recipe("graveyard_low_fog", "columns", (Finish((0.35, 0.34, 0.33), 1.0),), (key(0.5, -60, COOL), point(50, 0.25)), DUSK, ground=GRASS, fog=Fog(1.8, (0.7, 0.78, 0.85), falloff=1.6, offset=0.15), view=View(12, 9)),
    Recipe("stage_spots", "head", (Finish((0.5, 0.45, 0.42), 0.5),), (spot(-50, 0.8, 0.5, 0.3, WARM), spot(50, 0.8, 0.5, 0.3, COOL), spot(170, 0.9, 0.6)), World(1.0, (0.01, 0.01, 0.015)), ground=Finish((0.15, 0.14, 0.14), 0.5), fog=Fog(0.3, (0.85, 0.85, 0.85), 0.2), transform="Khronos PBR Neutral"),
    Recipe("blind_shafts", "blind", (Finish(BONE, 0.5), *(Finish((0.25, 0.24, 0.23), 0.8),) * 7), (sun(-60, 35, 1.2),), World(1.0, (0.05, 0.06, 0.09)), ground=GRAY, fog=Fog(0.4, (0.8, 0.8, 0.8), 0.3), view=View(35, 12)),
    Recipe("night_street", "house", (Finish((0.3, 0.3, 0.34), 0.8), metal((0.3, 0.32, 0.36), 0.5), glow(WARM, 3.0), Finish(GREEN, 1.0)), (point(-50, 0.4), point(50, 0.3, COOL), point(150, 0.4), point(-140, 0.3, COOL)), World(0.25, picture="night"), ground=Finish((0.12, 0.12, 0.13), 0.25), fog=Fog(0.6, (0.8, 0.8, 0.82)), view=View(25, 12)),
    Recipe("forest_fog", "rock", (Finish((0.2, 0.19, 0.17), 0.8),), (sun(140, 35, 0.4, 1.0, WARM),), World(0.8, picture="forest"), ground=GRASS, fog=Fog(0.8, (0.75, 0.82, 0.78), 0.2)),
    Recipe("low_ground_mist", "pebbles", (Finish((0.25, 0.24, 0.23), 0.5), metal(STEEL, 0.25)), (key(0.6),), World(0.5, picture="night"), ground=STONE, fog=Fog(2.5, (0.85, 0.88, 0.9), falloff=3.5), view=View(20, 18)),
    # lights and grades
    Recipe("four_lights", "head", (Finish((0.6, 0.6, 0.6), 0.5),), (key(0.35, -50, WARM), point(55, 0.3, COOL), spot(100, 0.5, 0.7), sun(-150, 40, 0.4)), World(1.0, (0.02, 0.02, 0.025)), "cove"),
    Recipe("noir", "head", (Finish((0.5, 0.48, 0.46), 0.25),), (spot(-75, 1.2, 0.5, 0.15), rim(0.3)), World(1.0, (0.01, 0.01, 0.012)), ground=GRAY, film={"contrast": 1.35, "saturation": 0.0, "vignette": 0.6, "exposure": 0.4}),
    Recipe("teal_orange", "car", (coat((0.65, 0.25, 0.04), 0.25), coat((0.65, 0.25, 0.04), 0.25), Finish(INK, 0.8)), (sun(55, 22, 0.8, 1.0, WARM),), World(0.7, picture="sunset"), ground=STONE, view=View(30, 10), film={"lift": (0.92, 1.0, 1.08), "gain": (1.15, 1.0, 0.88), "saturation": 1.15, "contrast": 1.1}, look="Medium High Contrast"),
    Recipe("faded_film", "plant", (Finish((0.7, 0.68, 0.62), 0.5), Finish((0.15, 0.32, 0.12), 0.25)), (sun(-35, 48, 0.6, 2.0),), World(0.8, picture="courtyard"), ground=BOARDS, film={"lift": (1.12, 1.1, 1.08), "contrast": 0.8, "saturation": 0.7, "hue": 6.0, "grade_gamma": 0.9}),
    Recipe("dreamy_glow", "letters", (Finish((0.7, 0.55, 0.65), 0.25),), (rim(2.5, 140), key(0.7, -50, (1.0, 0.8, 0.85))), World(1.0, (0.25, 0.2, 0.28)), "cove", film={"glare": 0.6, "gamma": 1.15, "midtone": (1.05, 1.0, 1.06), "vignette": 0.3}, transform="Filmic"),
    Recipe("punchy_toys", "trio", (Finish(RED, 0.1), Finish((0.05, 0.2, 0.6), 0.8), Finish((0.75, 0.55, 0.04), 0.5)), (sun(-40, 45, 0.8, 3.0), point(50, 0.3)), World(0.8, (0.5, 0.6, 0.75)), ground=WHITE, look="Punchy", film={"exposure": -0.3}),
)
# fmt: on
