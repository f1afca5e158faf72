# SPDX-License-Identifier: Apache-2.0
"""The typed structures between a sentence and the optimizer, whoever fills them in."""

from __future__ import annotations

from dataclasses import dataclass, field

from ..color.constants import Lab
from ..schema import Values
from ..schema.spec import Region


@dataclass(frozen=True)
class LightWords:
    """What a prompt may say of a light in the scene.

    Attributes:
        type: "POINT", "SPOT", "AREA" or "SUN".
        role: "key", "fill", "rim" or "other".
        turn: Azimuth relative to the camera, degrees: 0 behind it, 90 on its right; None if unknown.
        objects: Names of those that it mainly lights; none where that is unknown.
    """

    type: str = ""
    role: str = "other"
    turn: float | None = None
    objects: tuple[str, ...] = ()


GLOW = "material/"
"""How a material whose glow counts as a light is called among lights: this and its name."""


@dataclass(frozen=True)
class SceneWords:
    """The names in a scene that a prompt may mean; all empty when there is no scene.

    Attributes:
        subject: What the subject is called, say the mesh file's name; "" when unknown.
        objects: Object name -> "subject" or "surroundings".
        materials: Material name -> "subject" or "surroundings".
        object_materials: Object name -> names of the materials on it.
        lights: Light name -> what may be said of it.
        glows: Names of materials that emit light.
        groups: Collection or parent -> names of the objects in it.
        places: Object name -> x (-1 left, 1 right), y (0 near, 1 far), and size as a share of the picture's width.
    """

    subject: str = ""
    objects: dict[str, Region] = field(default_factory=dict)
    materials: dict[str, Region] = field(default_factory=dict)
    object_materials: dict[str, tuple[str, ...]] = field(default_factory=dict)
    lights: dict[str, LightWords] = field(default_factory=dict)
    glows: tuple[str, ...] = ()
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)
    places: dict[str, tuple[float, float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Attribute:
    """One look word of the prompt, bound to what it describes.

    Attributes:
        word: As the prompt says it, with its intensity or negation: "very glossy", "no fog".
        entry: Name of the vocabulary entry, or of the color.
        slot: "color", "finish", "material", "lighting", "atmosphere", "grade", "mood" or "setting".
        region: The part of the picture that it describes.
        kind: The kind of thing that it describes: "subject", "surroundings", "sky", "light", "fog", ...
        strength: 1 as named; below for "slightly", above for "very".
        negated: "no", "without", "not".
        owners: Materials that are meant; empty for all of the region.
        lamp: Number of the light that is meant, where the prompt tells several apart by color or side; else 0.
        role: The lights that are meant: "key", "fill", "rim" or "others"; "" for light in general.
        color: The named color, sRGB in [0, 1]; None unless the slot is "color".
        thing: What the prompt calls the thing that it describes: "teapot", "wall", "key light".
        cause: The mood or style word that stands for this one, as the prompt says it; "" when the prompt says this one itself.
        guess: Not a known word, but this is the nearest one.
        shades: How a material's own color is changed ("dark oak"): arguments of `color.shade`, one after the other.
        lights: Names of the lights that are meant, where the words single them out; of a glow "material/NAME".
        english: The word in English, where the prompt says it in another language.
        place: Where it begins and ends in the prompt, where that is in another language; None if unknown.
    """

    word: str
    entry: str
    slot: str
    region: Region
    kind: str = "subject"
    strength: float = 1.0
    negated: bool = False
    owners: tuple[str, ...] = ()
    role: str = ""
    color: Values | None = None
    thing: str = ""
    cause: str = ""
    guess: bool = False
    shades: tuple[tuple[float, float, float, float], ...] = ()
    lamp: int = 0
    lights: tuple[str, ...] = ()
    english: str = ""
    place: tuple[int, int] | None = None

    @property
    def told_apart(self) -> bool:
        """Whether it is said of some lights, and not of light as a whole."""
        return bool(self.lamp or self.lights)


@dataclass
class PromptObject:
    """Something that the prompt describes, in the foreground or around it.

    Attributes:
        name: "teapot", "wall"; "subject" or "surroundings" where the prompt names nothing.
        region: "subject" or "surroundings".
        attributes: Slot -> words, comma separated: {"color": "teal", "finish": "very glossy"}.
        materials: Materials that it is made of; empty when no name in the scene matches.
    """

    name: str
    region: Region
    attributes: dict[str, str] = field(default_factory=dict)
    materials: tuple[str, ...] = ()


@dataclass
class Parsed:
    """A prompt, understood.

    Attributes:
        prompt: The text, white space tidied.
        objects: At least one for the subject.
        attributes: Every look word found, in the order of the text.
        targets: Attribute head -> class that the words ask for, see `attributes.ATTRIBUTES`.
        colors: "subject"/"surroundings" -> Lab that its mean display color should come near.
        ignored: Words that could not be used, in the order of the text.
        guesses: Unknown word -> vocabulary entry that it was taken for.
        conflicts: Contradictions, and how each was resolved, one sentence each.
        confidence: Guessed word -> how sure the guess is, in [0, 1].
        overruled: Attributes that ask for nothing but what earlier ones contradict.
    """

    prompt: str
    objects: list[PromptObject] = field(default_factory=list)
    attributes: list[Attribute] = field(default_factory=list)
    targets: dict[str, str] = field(default_factory=dict)
    colors: dict[Region, Lab] = field(default_factory=dict)
    ignored: list[str] = field(default_factory=list)
    guesses: dict[str, str] = field(default_factory=dict)
    conflicts: list[str] = field(default_factory=list)
    confidence: dict[str, float] = field(default_factory=dict)
    overruled: list[Attribute] = field(default_factory=list)


@dataclass(frozen=True)
class Prompts:
    """What the encoder is asked, region by region (equations 5 and 6); never negations.

    Attributes:
        subject: Short caption of the subject alone.
        surroundings: Short caption of the surroundings alone; "" when the words leave them open.
        whole: Caption of the whole picture.
        subject_negatives: What the subject must not look like: swaps and antonyms, positively worded.
        surroundings_negatives: Likewise for the surroundings.
        whole_negatives: Likewise for the whole picture: "thick fog" for "no fog".
    """

    subject: str
    surroundings: str
    whole: str
    subject_negatives: tuple[str, ...] = ()
    surroundings_negatives: tuple[str, ...] = ()
    whole_negatives: tuple[str, ...] = ()


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
    """

    lower: Values
    upper: Values
    priority: int | None
    reason: str
    prior: float = 1.0
    usual: bool = False
    any_hue: bool = False


class Plan(dict[str, PlanEntry]):
    """An entry for every instance of the scene, by key.

    Attributes:
        notes: Contradictions resolved and bounds that stood in the way, one sentence each.
    """

    def __init__(self, entries: dict[str, PlanEntry] | None = None, notes: tuple[str, ...] = ()) -> None:
        super().__init__(entries or {})
        self.notes = notes
