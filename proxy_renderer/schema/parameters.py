# SPDX-License-Identifier: Apache-2.0
"""The table: every value that a vibe may change, in Blender's own terms, and the words that may change it."""

import hashlib
import json
import math
from dataclasses import asdict, dataclass, field
from fnmatch import fnmatchcase
from functools import partial
from typing import Literal

Kind = Literal["scalar", "color", "angle"]
Region = Literal["subject", "surroundings", "whole"]
Values = tuple[float, ...]


@dataclass(frozen=True)
class Scale:
    """A monotone map between a bounded value and u in [0, 1], where equal steps of u look about equally large."""

    name: Literal["linear", "log", "power"] = "linear"  # "log" needs a positive lower bound
    exponent: float = 1.0  # for "power": value = lower + (upper - lower) * u ** exponent

    def to_unit(self, value: float, lower: float, upper: float) -> float:
        """Maps a value, clamped to its bounds, to u in [0, 1].

        >>> Scale("log").to_unit(10.0, 1.0, 100.0), Scale().to_unit(7.0, 0.0, 4.0)
        (0.5, 1.0)
        """
        value = min(max(value, lower), upper)
        if self.name == "log":
            return math.log(value / lower) / math.log(upper / lower)
        return ((value - lower) / (upper - lower)) ** (1.0 / self.exponent)

    def from_unit(self, u: float, lower: float, upper: float) -> float:
        """Inverse of `to_unit`."""
        u = min(max(u, 0.0), 1.0)
        if self.name == "log":
            return lower * (upper / lower) ** u
        return lower + (upper - lower) * u**self.exponent


LINEAR = Scale()
LOG = Scale("log")
SRGB = Scale("power", 2.2)  # color components: even steps in u are about even steps on screen


@dataclass(frozen=True)
class Parameter:
    """One row of the schema: a kind of value, of which a scene may have none, one or several."""

    group: str  # camera, light, world, material, volume or film
    name: str  # unique within the group
    kind: Kind  # "scalar", "color" (three linear Rec.709 components) or "angle" (degrees)
    default: float  # value of each component that keeps the image as in a new Blender scene
    lower: float  # hard lower bound of every component, in `unit`; times the instance's reference
    upper: float  # hard upper bound, with the same unit and factor
    unit: str  # "", "W", "W/m2", "m", "1/m", "deg", "K" or "stops"
    scale: Scale  # the perceptual scale that optimization steps on
    region: Region  # the part of the image that it mainly changes
    doc: str  # what it does, for help texts and tool tips
    blender: str  # the socket or property that it means, as an artist would look for it
    reference: str = ""  # the scene length (see `REFERENCES`) that bounds are multiples of; "" for none
    only: tuple[str, ...] = ()  # the kinds of owner that have it (light types, say); empty for all

    @property
    def family(self) -> str:
        """The name shared by all instances: "material/roughness"."""
        return f"{self.group}/{self.name}"

    @property
    def components(self) -> int:
        """3 for colors, otherwise 1."""
        return 3 if self.kind == "color" else 1

    def key(self, owner: str = "") -> str:
        """The key of an instance: "material/Body/roughness" for the owner "Body", "film/contrast" without an owner."""
        return f"{self.group}/{owner}/{self.name}" if owner else self.family


@dataclass(frozen=True)
class Instance:
    """A parameter of one owner (a light, a material, the film) in one scene, with its value and bounds."""

    parameter: Parameter  # the schema row
    owner: str  # name of the light or material; "" for groups that a scene has one of
    value: Values  # the artist's value, one float per component, in the parameter's unit
    reference: float = 1.0  # factor on the schema's bounds: the scene length that the parameter refers to
    role: str = ""  # "subject" or "surroundings" for materials; "key", "fill", "rim" for lights
    locked: str = ""  # why the value must stay as it is; "" when it may change
    lower: Values = field(init=False)
    upper: Values = field(init=False)

    def __post_init__(self) -> None:
        # The artist's value is always legal: the bounds are widened to include it.
        low, high = (b * self.reference for b in (self.parameter.lower, self.parameter.upper))
        object.__setattr__(self, "lower", tuple(min(low, v) for v in self.value))
        object.__setattr__(self, "upper", tuple(max(high, v) for v in self.value))
        if self.parameter.scale.name == "log":
            object.__setattr__(self, "lower", tuple(max(v, low * 1e-3) for v in self.lower))

    @property
    def key(self) -> str:
        """The name in reports, presets, locks and messages, see `Parameter.key`."""
        return self.parameter.key(self.owner)

    def distance(self, value: Values) -> float:
        """The greatest distance of a component of `value` from the artist's value, on the perceptual scale, 0 to 1."""
        unit = self.parameter.scale.to_unit
        ends = zip(self.value, value, self.lower, self.upper, strict=True)
        return max(abs(unit(a, low, high) - unit(b, low, high)) for a, b, low, high in ends)


def split_key(key: str) -> tuple[str, str, str]:
    """Splits a key into (group, owner, name); the owner is "" if a scene has only one of the group.

    An owner's name may itself contain slashes.

    >>> split_key("material/Wood/Oak/roughness"), split_key("film/contrast")
    (('material', 'Wood/Oak', 'roughness'), ('film', '', 'contrast'))
    """
    group, _, rest = key.partition("/")
    owner, _, name = rest.rpartition("/")
    return group, owner, name


def matches(key: str, patterns: tuple[str, ...] | list[str]) -> bool:
    """True if one of the patterns fits a key. A pattern is a group, a group with an owner, a key, or a glob of keys.

    >>> matches("light/Key/power", ["light"]), matches("light/Key/power", ["*/power"])
    (True, True)
    """
    group, owner, _ = split_key(key)
    return any(p in (group, f"{group}/{owner}", key) or fnmatchcase(key, p) for p in patterns)


# A mood never repaints the scene. Moods, light words, places, weather, seasons, times of day and grade words are served by
# lights, world, air and film. A material changes only for a word that the prompt itself says, that is bound to it, and that
# speaks of its color, substance or finish. The glow of a material that lights the scene counts as a light, not as paint.
PAINT = "material"  # the group of parameters that only words about surfaces may change
_NO_PAINT = frozenset(("light", "world", "volume", "film"))
MEANS: dict[str, frozenset[str]] = {  # slot of a word -> groups of parameters that may serve it
    **dict.fromkeys(("color", "finish", "material"), _NO_PAINT | {PAINT}),
    **dict.fromkeys(("lighting", "atmosphere", "grade", "mood", "setting"), _NO_PAINT),
}
SURFACES = tuple(slot for slot, groups in MEANS.items() if PAINT in groups)  # slots of words about surfaces
PICTURE = "picture"  # the slot of a reference image's wishes, which all groups may serve


def may_serve(group: str, slot: str, cause: str = "") -> bool:
    """True if parameters of a group may change for a word of a slot; materials not if a mood, `cause`, implies it."""
    return slot == PICTURE or (group in MEANS[slot] and not (cause and group == PAINT))


VERSION = 1  # raised when a row's meaning changes: presets carry it, and a newer one is refused
REFERENCES = {  # scene lengths that bounds are multiples of, measured once, before anything is changed
    "light_distance": "distance from the light to the subject's center, meters",
    "light_distance_squared": "the same, squared: it cancels the inverse square law",
    "view_distance": "distance from the camera to the subject's center, meters",
    "per_view_distance": "its inverse: a density becomes the optical depth to the subject",
    "subject_height": "height of the subject's bounding box, meters",
    "per_subject_height": "its inverse",
}

_LAMPS = ("POINT", "SPOT", "AREA")
GROUPS = ("camera", "light", "world", "material", "volume", "film")
_camera, _light, _world, _material, _volume, _film = (partial(Parameter, group) for group in GROUPS)

# fmt: off
PARAMETERS: tuple[Parameter, ...] = (
    #       name                kind      default  lower   upper   unit    scale              region
    _camera("azimuth",          "angle",  0.0,   -360.0,   360.0,  "deg",  LINEAR,            "whole",
            "Where the camera stands around the subject; 0 is in front (-Y), 90 on its left-hand side (+X).", "Camera object, orbit around the subject"),
    _camera("elevation",        "angle",  10.0,   -85.0,    85.0,  "deg",  LINEAR,            "whole",
            "How far the camera looks down on the subject.", "Camera object, orbit around the subject"),
    _camera("distance",         "scalar", 1.0,      0.4,     2.5,  "m",    LOG,               "whole",
            "Distance from the camera to the subject's center.", "Camera object, orbit around the subject", reference="view_distance"),
    _camera("fov",              "angle",  40.0,     8.0,   100.0,  "deg",  LOG,               "whole",
            "Field of view along the picture's longer side.", "Camera > Lens > Field of View"),

    _light("power",             "scalar", 40.0,    0.05,  4000.0,  "W",    LOG,               "whole",
           "Radiant power.", "Light > Power", reference="light_distance_squared", only=_LAMPS),
    _light("strength",          "scalar", 3.0,    0.005,   100.0,  "W/m2", LOG,               "whole",
           "Irradiance of a surface that faces the sun.", "Sun light > Strength", only=("SUN",)),
    _light("color",             "color",  1.0,      0.0,     1.0,  "",     SRGB,              "whole",
           "Tint of the light, on top of its temperature.", "Light > Color"),
    _light("temperature",       "scalar", 6500.0, 1200.0, 16000.0, "K",    LOG,               "whole",
           "Color temperature: low is warm, 6500 is white, high is cool.", "Light > Temperature (Blender 4.5 and later)"),
    _light("size",              "scalar", 0.2,    0.002,     3.0,  "m",    LOG,               "whole",
           "Size of the lamp: the larger, the softer its shadows.", "Light > Radius, or Size of an area light", reference="light_distance", only=_LAMPS),
    _light("angle",             "angle",  0.526,    0.0,    90.0,  "deg",  Scale("power", 2), "whole",
           "Angular diameter of the sun: the larger, the softer its shadows.", "Sun light > Angle", only=("SUN",)),
    _light("cone",              "angle",  45.0,     4.0,   160.0,  "deg",  LOG,               "whole",
           "Opening angle of a spot's cone: the smaller, the smaller its pool of light.", "Spot light > Spot Size", only=("SPOT",)),
    _light("azimuth",           "angle",  45.0,  -360.0,   360.0,  "deg",  LINEAR,            "whole",
           "Direction that the light comes from, around the subject; 0 is from the front (-Y).", "Light object, orbit around the subject"),
    _light("elevation",         "angle",  45.0,   -89.0,    89.0,  "deg",  LINEAR,            "whole",
           "Height that the light comes from; 90 is straight above.", "Light object, orbit around the subject"),
    _light("distance",          "scalar", 1.0,      0.3,     4.0,  "m",    LOG,               "whole",
           "Distance from the light to the subject's center.", "Light object, orbit around the subject", reference="light_distance", only=_LAMPS),

    _world("color",             "color",  0.05,     0.0,     1.0,  "",     SRGB,              "surroundings",
           "Color of the background and of the light that it sheds.", "World > Background > Color"),
    _world("tint",              "color",  1.0,      0.0,     2.0,  "",     SRGB,              "surroundings",
           "Multiplies a linked environment.", "World > Vibe Tint > Tint"),
    _world("strength",          "scalar", 1.0,      0.0,    10.0,  "",     Scale("power", 3), "whole",
           "Strength of the background.", "World > Background > Strength"),
    _world("rotation",          "angle",  0.0,   -360.0,   360.0,  "deg",  LINEAR,            "whole",
           "Turns a linked environment around the vertical axis.", "World > Mapping > Rotation Z"),
    _world("backdrop_color",    "color",  0.05,     0.0,     1.0,  "",     SRGB,              "surroundings",
           "Color of a background that only the camera sees.", "World > Background of camera rays > Color"),
    _world("backdrop_tint",     "color",  1.0,      0.0,     2.0,  "",     SRGB,              "surroundings",
           "Multiplies a linked background that only the camera sees.", "World > Vibe Tint > Tint"),
    _world("backdrop_strength", "scalar", 1.0,      0.0,    10.0,  "",     Scale("power", 3), "surroundings",
           "Strength of a background that only the camera sees.", "World > Background of camera rays > Strength"),
    _world("backdrop_horizon",  "color",  1.0,      0.0,     4.0,  "",     SRGB,              "surroundings",
           "Multiplies a background that only the camera sees. The tint is full at the horizon and fades towards the top of the image.", "World > Vibe Horizon > Horizon"),

    _material("base_color",     "color",  0.8,      0.0,     1.0,  "",     SRGB,              "subject",
              "Albedo of the surface, or reflectance of a metal.", "Principled BSDF > Base Color"),
    _material("tint",           "color",  1.0,      0.0,     4.0,  "",     SRGB,              "subject",
              "Multiplies a linked base color.", "Vibe Tint > Tint"),
    _material("recolor",        "scalar", 0.0,      0.0,     1.0,  "",     LINEAR,            "subject",
              "How much of a linked base color, or else of a linked glow, is reduced to its luminance before the tint.", "Vibe Tint > Recolor"),
    _material("metallic",       "scalar", 0.0,      0.0,     1.0,  "",     LINEAR,            "subject",
              "From dielectric (0) to metal (1).", "Principled BSDF > Metallic"),
    _material("roughness",      "scalar", 0.5,      0.0,     1.0,  "",     LINEAR,            "subject",
              "From mirror-sharp (0) to matte (1).", "Principled BSDF > Roughness"),
    _material("ior",            "scalar", 1.5,      1.0,     3.0,  "",     LINEAR,            "subject",
              "Index of refraction: the strength of reflection and the bending of light.", "Principled BSDF > IOR"),
    _material("specular",       "scalar", 0.5,      0.0,     1.0,  "",     LINEAR,            "subject",
              "Scales the dielectric reflection; 0.5 leaves it as the IOR says.", "Principled BSDF > Specular IOR Level"),
    _material("specular_tint",  "color",  1.0,      0.0,     1.0,  "",     SRGB,              "subject",
              "Color of dielectric reflection, and of a metal's edge.", "Principled BSDF > Specular Tint"),
    _material("coat",           "scalar", 0.0,      0.0,     1.0,  "",     LINEAR,            "subject",
              "Clear lacquer on top.", "Principled BSDF > Coat Weight"),
    _material("coat_roughness", "scalar", 0.03,     0.0,     1.0,  "",     LINEAR,            "subject",
              "Roughness of the lacquer.", "Principled BSDF > Coat Roughness"),
    _material("sheen",          "scalar", 0.0,      0.0,     1.0,  "",     LINEAR,            "subject",
              "Soft glow at grazing angles: velvet, dust.", "Principled BSDF > Sheen Weight"),
    _material("transmission",   "scalar", 0.0,      0.0,     1.0,  "",     LINEAR,            "subject",
              "From opaque (0) to glass (1).", "Principled BSDF > Transmission Weight"),
    _material("emission_color", "color",  1.0,      0.0,     1.0,  "",     SRGB,              "subject",
              "Color of the glow.", "Principled BSDF > Emission Color"),
    _material("emission",       "scalar", 0.0,      0.0,    20.0,  "",     Scale("power", 3), "subject",
              "Strength of the glow; multiplies one that nodes compute.", "Principled BSDF > Emission Strength"),

    _volume("density",          "scalar", 0.0,      0.0,     8.0,  "1/m",  Scale("power", 3), "surroundings",
            "Extinction of the fog at its base.", "Vibe Fog > Density", reference="per_view_distance"),
    _volume("color",            "color",  0.8,      0.0,     1.0,  "",     SRGB,              "surroundings",
            "Single-scattering albedo of the fog.", "Vibe Fog > Color"),
    _volume("anisotropy",       "scalar", 0.0,     -0.8,     0.9,  "",     LINEAR,            "surroundings",
            "Backward (-), even (0) or forward (+) scattering.", "Vibe Fog > Anisotropy"),
    _volume("falloff",          "scalar", 0.0,      0.0,     8.0,  "1/m",  Scale("power", 2), "surroundings",
            "How fast the fog thins with height; 0 is the same everywhere.", "Vibe Fog > Height Falloff", reference="per_subject_height"),
    _volume("offset",           "scalar", 0.0,     -2.0,     2.0,  "m",    LINEAR,            "surroundings",
            "Height at which the fog starts to thin, above the subject's base.", "Vibe Fog > Height Offset", reference="subject_height"),

    _film("exposure",           "scalar", 0.0,     -6.0,     6.0,  "stops", LINEAR,           "whole",
          "Brightness of the whole picture, before the view transform.", "Render > Color Management > Exposure"),
    _film("gamma",              "scalar", 1.0,      0.4,     2.5,  "",     LOG,               "whole",
          "Gamma after the view transform.", "Render > Color Management > Gamma"),
    _film("grade_exposure",     "scalar", 0.0,     -3.0,     3.0,  "stops", LINEAR,           "whole",
          "Brightness in the compositor, before the rest of the grade.", "Vibe Grade > Exposure"),
    _film("lift",               "color",  1.0,      0.7,     1.3,  "",     LINEAR,            "whole",
          "Tint and level of the shadows.", "Vibe Grade > Lift"),
    _film("midtone",            "color",  1.0,      0.6,     1.5,  "",     LINEAR,            "whole",
          "Tint and level of the midtones.", "Vibe Grade > Midtone"),
    _film("gain",               "color",  1.0,      0.5,     1.6,  "",     LINEAR,            "whole",
          "Tint and level of the highlights.", "Vibe Grade > Gain"),
    _film("contrast",           "scalar", 1.0,      0.5,     2.0,  "",     LOG,               "whole",
          "Contrast around middle gray.", "Vibe Grade > Contrast"),
    _film("saturation",         "scalar", 1.0,      0.0,     2.0,  "",     LINEAR,            "whole",
          "From gray (0) over unchanged (1) to vivid (2).", "Vibe Grade > Saturation"),
    _film("hue",                "angle",  0.0,    -90.0,    90.0,  "deg",  LINEAR,            "whole",
          "Turns every hue.", "Vibe Grade > Hue"),
    _film("grade_gamma",        "scalar", 1.0,      0.5,     2.0,  "",     LOG,               "whole",
          "Exponent on the graded picture: above 1 darkens the midtones.", "Vibe Grade > Gamma"),
    _film("vignette",           "scalar", 0.0,      0.0,     1.0,  "",     LINEAR,            "whole",
          "Darkens the corners.", "Vibe Grade > Vignette"),
    _film("glare",              "scalar", 0.0,      0.0,     1.0,  "",     LINEAR,            "whole",
          "Bloom around highlights.", "Vibe Grade > Glare"),
)
# fmt: on

FAMILIES: dict[str, Parameter] = {p.family: p for p in PARAMETERS}


def schema_hash() -> str:
    """A fingerprint of the parameter table: 16 hexadecimal digits, which must be the same in Blender and the engine."""
    rows = [VERSION, *(asdict(p) for p in PARAMETERS)]
    return hashlib.sha256(json.dumps(rows, sort_keys=True).encode()).hexdigest()[:16]
