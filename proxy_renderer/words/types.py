# SPDX-License-Identifier: Apache-2.0
"""The typed structures between a sentence and a plan, whoever fills them in."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from ..color.constants import Lab
from ..schema import Values, VibeError
from ..schema.parameters import Region
from ..schema.targets import NOT_USED

if TYPE_CHECKING:
    from .lexicon.vocabulary import Vocabulary

T = TypeVar("T")


@dataclass(frozen=True)
class LightDescription:
    """A light of a scene.

    Attributes:
        type: "POINT", "SPOT", "AREA" or "SUN"; "" if unknown.
        role: "key", "fill", "rim" or "other".
        turn: Azimuth relative to the camera, degrees: 0 behind it, 90 on its right; None if unknown.
        objects: Names of those that it mainly lights; none where that is unknown.
        stops: Added to its power by Blender (its `exposure`).
        elevations: Lowest and highest elevation that floor and ceiling leave it, degrees.
    """

    type: str = ""
    role: str = "other"
    turn: float | None = None
    objects: tuple[str, ...] = ()
    stops: float = 0.0
    elevations: tuple[float, float] = (-90.0, 90.0)


@dataclass(frozen=True)
class MaterialLook:
    """How a material looks before any wish.

    Attributes:
        color: sRGB in [0, 1], that of its glow where it glows; None where nothing says it.
        glows: Whether it emits light.
        share: Of the image's pixels.
        worn: Object -> the share of the image that it covers with the material.
        structures: What it clearly is by its shape: "ground", "support" (the subject stands on it), "wall", "roof", "ceiling".
    """

    color: Values | None = None
    glows: bool = False
    share: float = 0.0
    worn: Mapping[str, float] = field(default_factory=dict)
    structures: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Glow:
    """Light of a material that emits.

    Attributes:
        light: Radiance of a white surface at the subject that faces it, if its own radiance is 1.
        azimuth: Direction in which it is seen from the subject, degrees, as in `schema.orbit`.
        objects: Names of the objects that show it.
        color: Mean color that nodes compute, linear; its emission color multiplies it. White where nodes compute none.
        strength: Mean strength that nodes compute; its emission multiplies it. 1 where nodes compute none.
    """

    light: float
    azimuth: float
    objects: tuple[str, ...] = ()
    color: Values = (1.0, 1.0, 1.0)
    strength: float = 1.0


@dataclass(frozen=True)
class PictureStats:
    """Measurements of the current image.

    Attributes:
        lab: "subject"/"surroundings" -> mean display color.
        percentiles: Display lightness L* of the whole image at 5, 50 and 95 percent.
    """

    lab: dict[Region, Lab] = field(default_factory=dict)
    percentiles: tuple[float, float, float] | None = None


WEAKEST, STRONGEST = 0.05, 3.0
"""Strengths of words, however many intensities stand before them: "very, very, very dark" is as dark as it gets."""
GLOW = "material/"
"""How a material whose glow counts as a light is called among lights: this and its name."""


@dataclass(frozen=True)
class SceneDescription:
    """A scene as words and plans know it; everything is empty or unknown where there is none.

    Attributes:
        subject: Name of the subject, say the mesh file's; "" when unknown.
        objects: Object name -> region.
        materials: Material name -> region.
        object_materials: Object name -> names of the materials on it.
        lights: Light name -> its description.
        glows: Names of materials that emit light.
        groups: Collection or parent -> names of the objects in it.
        places: Object name -> x (-1 left, 1 right), y (0 near, 1 far), and size as a share of the image's width.
        looks: Material name -> its present look; empty where only names are known.
        sky: Whether the camera sees the sky.
        added_lights: Light that the scene lacks and that the words ask for -> the light.
        emitters: Material -> light of its emission; also of a material whose emission is black.
        camera_azimuth: Degrees, as in `schema.orbit`: light directions are relative to it.
        view: View transform: "AgX", "Filmic", "Standard", ...
        world_share: Share of the surroundings' pixels that show the world, not a surface; None if unknown.
        material_share: Material -> share of its region's pixels; empty if unknown.
        environment_luminance: Mean luminance of a linked environment at strength 1, untinted.
        backdrop_luminance: The same of a linked backdrop that only the camera sees.
        texture_luminance: Material -> mean luminance of its linked base color.
        values: Current values by key; the artist's where missing.
        picture: Measurements of the image that these values give; None before the first one.
    """

    subject: str = ""
    objects: dict[str, Region] = field(default_factory=dict)
    materials: dict[str, Region] = field(default_factory=dict)
    object_materials: dict[str, tuple[str, ...]] = field(default_factory=dict)
    lights: dict[str, LightDescription] = field(default_factory=dict)
    glows: tuple[str, ...] = ()
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)
    places: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    looks: Mapping[str, MaterialLook] = field(default_factory=dict)
    sky: bool = True
    added_lights: dict[str, LightDescription] = field(default_factory=dict)
    emitters: dict[str, Glow] = field(default_factory=dict)
    camera_azimuth: float = 0.0
    view: str = "AgX"
    world_share: float | None = None
    material_share: dict[str, float] = field(default_factory=dict)
    environment_luminance: float = 0.5
    backdrop_luminance: float = 0.5
    texture_luminance: dict[str, float] = field(default_factory=dict)
    values: dict[str, Values] = field(default_factory=dict)
    picture: PictureStats | None = None
    _made: dict[Any, tuple[Vocabulary, Any]] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )

    def made(self, make: Callable[[SceneDescription, Vocabulary], T], vocabulary: Vocabulary) -> T:
        """An object that is made of the names and a vocabulary, once for all prompts."""
        if make not in self._made or self._made[make][0] is not vocabulary:
            self._made[make] = vocabulary, make(self, vocabulary)
        made: T = self._made[make][1]
        return made

    def light(self, name: str) -> LightDescription:
        """A light by its name, an added one too."""
        return self.lights.get(name) or self.added_lights.get(name) or LightDescription()


@dataclass(frozen=True)
class Attribute:
    """One look word of the prompt, bound to what it describes.

    Attributes:
        word: As the prompt says it, with its intensity or negation: "very glossy", "no fog".
        entry: Name of the vocabulary entry, or of the color.
        slot: "color", "finish", "material", "lighting", "atmosphere", "grade", "mood" or "setting".
        region: Of the image.
        kind: Kind of the thing that it describes: "subject", "surroundings", "sky", "light", "fog", ...
        strength: 1 as named; below for "slightly", above for "very".
        negated: "no", "without", "not".
        owners: Materials that are meant; empty for all of the region.
        lamp: Number of the light that is meant, where the prompt tells several apart by color or side; else 0.
        phrases: Numbers of the lights that the prompt describes one by one, see `attributes.light_phrases`.
        look: Number of the look word in the prompt, from 0; -1 where no reader has bound it.
        role: The lights that are meant: "key", "fill", "rim" or "others"; "" for light in general.
        color: The named color, sRGB in [0, 1]; None unless the slot is "color".
        thing: What the prompt calls the thing that it describes: "teapot", "wall", "key light".
        cause: The mood or style word that stands for this one, as the prompt says it; "" when the prompt says this one itself.
        guess: Misspelled, and taken for the known word.
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
    phrases: tuple[int, ...] = ()
    look: int = field(default=-1, compare=False)

    @property
    def of_glows(self) -> bool:
        """Whether it is about surfaces that glow, which count as lights."""
        return any(name.startswith(GLOW) for name in self.lights)

    @property
    def told_apart(self) -> bool:
        """Whether it is said of some lights, and not of light as a whole."""
        return bool(self.lamp or self.lights)

    @property
    def of_one_light(self) -> bool:
        """Whether it is about one of several lights: what another one is like does not concern it."""
        return bool(self.told_apart or self.role or self.owners)


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


@dataclass(frozen=True)
class Candidate:
    """Something that a word may describe.

    Attributes:
        name: As `--target` takes it, see `schema.targets`.
        probability: By the reader's weights, in the prompt as a whole.
    """

    name: str
    probability: float


@dataclass(frozen=True)
class PromptWord:
    """A word of the prompt, understood: a look word, or a word that is not used.

    Attributes:
        text: As the prompt says it, with its intensity or negation: "very glossy".
        key: What `--target` calls it: "glossy", or "red#2" where the prompt says it several times.
        place: Where it begins and ends in the prompt; None if unknown.
        entry: Its sense: name of the vocabulary entry, or of the color; "" where it is not used.
        strength: 1 as named; below for "slightly", above for "very".
        negated: "no", "without", "not".
        target: Name of what it describes, see `schema.targets`; "not used" where it is left out.
        thing: What the prompt calls that: "cube"; "" where it says only the word.
        confidence: Probability of the target; 1 where the artist says so, or the scene lacks what the prompt names.
        candidates: What it may describe, the target first, then the likeliest; empty for a word that is no look word.
        others: What else of the scene it can describe.
        guess: The known word that it is taken for, where it is misspelled.
    """

    text: str
    key: str
    place: tuple[int, int] | None = None
    entry: str = ""
    strength: float = 1.0
    negated: bool = False
    target: str = NOT_USED
    thing: str = ""
    confidence: float = 1.0
    candidates: tuple[Candidate, ...] = ()
    others: tuple[str, ...] = ()
    guess: str = ""

    @property
    def is_used(self) -> bool:
        """Whether it describes something."""
        return self.target != NOT_USED

    def row(self) -> dict[str, Any]:
        """The word as the report and `--json` have it: everything but what else it could describe."""
        return {name: value for name, value in asdict(self).items() if name != "others"}


@dataclass
class Parsed:
    """A prompt, understood.

    Attributes:
        prompt: The text, white space tidied.
        objects: At least one for the subject.
        attributes: Every look word found, in the order of the text.
        ignored: Words that could not be used, in the order of the text.
        guesses: Misspelled word -> the known word, or the name in the scene, that it was taken for.
        notes: What the artist should hear of how the prompt was read, one sentence each.
        protected: Owners of parameters that the prompt says should stay: "material/Plaster", "light/Key", "world".
        words: Its look words and what is left out, in the order of the text.
        unknown: Why nothing in it is understood; None where something is.
    """

    prompt: str
    objects: list[PromptObject] = field(default_factory=list)
    attributes: list[Attribute] = field(default_factory=list)
    ignored: list[str] = field(default_factory=list)
    guesses: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    protected: tuple[str, ...] = ()
    words: tuple[PromptWord, ...] = ()
    unknown: VibeError | None = None
