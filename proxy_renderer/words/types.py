# SPDX-License-Identifier: Apache-2.0
"""The data structures between a prompt and a plan, independent of how the prompt is read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeVar

from ..color.constants import Lab
from ..schema import Values, VibeError
from ..schema.parameters import Region
from ..schema.targets import NOT_USED

if TYPE_CHECKING:
    from .lexicon.vocabulary import Vocabulary

T = TypeVar("T")
Part = Literal["subject", "surroundings", "sky", "picture"]  # of the image; the sky is the visible sky


@dataclass(frozen=True)
class LightDescription:
    """A light of a scene."""

    type: str = ""  # "POINT", "SPOT", "AREA" or "SUN"; "" if unknown
    role: str = "other"  # "key", "fill", "rim" or "other"
    turn: float | None = None  # azimuth from the camera, degrees: 0 behind it, 90 on its right; None: unknown
    objects: tuple[str, ...] = ()  # names of objects that it mainly lights; () if unknown
    stops: float = 0.0  # added to its power by Blender (its `exposure`)


@dataclass(frozen=True)
class MaterialLook:
    """Look of a material before any wish."""

    color: Values | None = None  # sRGB in [0, 1], of its glow if it glows; None if unknown
    glows: bool = False  # whether it emits light
    share: float = 0.0  # of the image's pixels that show it
    worn: Mapping[str, float] = field(default_factory=dict)  # object -> its share of the image with it
    # what its shape clearly is: "ground", "support" (the subject stands on it), "wall", "roof", "ceiling"; "walls" for
    # each of several materials of walls
    structures: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Glow:
    """Light that a material emits."""

    light: float  # radiance of a white surface at the subject that faces it, if its own radiance is 1
    azimuth: float  # direction in which it is seen from the subject, degrees, as in `schema.orbit`
    objects: tuple[str, ...] = ()  # names of the objects that show it
    # mean color that nodes compute, linear; its emission color multiplies it. White where nodes compute none
    color: Values = (1.0, 1.0, 1.0)
    strength: float = 1.0  # mean that nodes compute; its emission multiplies it. 1 where they compute none


@dataclass(frozen=True)
class PictureStats:
    """Measurements of the current image."""

    lab: dict[Region, Lab] = field(default_factory=dict)  # "subject"/"surroundings" -> mean display color
    percentiles: tuple[float, float, float] | None = None  # L* of the image at 5, 50 and 95 percent


WEAKEST, STRONGEST = 0.05, 3.0  # limits of the strength of a word: "very, very, very dark"
GLOW = "material/"  # before the name of a material in a list of lights: the glow of that material


@dataclass(frozen=True)
class SceneDescription:
    """A scene as words and plans know it; what is not known is empty or None."""

    subject: str = ""  # name of the subject, say the mesh file's; "" when unknown
    objects: dict[str, Region] = field(default_factory=dict)  # object name -> region
    materials: dict[str, Region] = field(default_factory=dict)  # material name -> region
    object_materials: dict[str, tuple[str, ...]] = field(default_factory=dict)  # object -> its materials
    lights: dict[str, LightDescription] = field(default_factory=dict)  # light name -> its description
    glows: tuple[str, ...] = ()  # names of materials that emit light
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)  # collection or parent -> objects
    # material name -> its present look; empty where only names are known
    looks: Mapping[str, MaterialLook] = field(default_factory=dict)
    sky: bool = True  # whether the camera sees the sky
    # light that the scene lacks and that the words ask for -> the light
    added_lights: dict[str, LightDescription] = field(default_factory=dict)
    # material -> light of its emission; also of a material whose emission is black
    emitters: dict[str, Glow] = field(default_factory=dict)
    camera_azimuth: float = 0.0  # Degrees, as in `schema.orbit`: light directions are relative to it
    view: str = "AgX"  # view transform: "AgX", "Filmic", "Standard", ...
    world_share: float | None = None  # of the surroundings' pixels that show the world; None if unknown
    material_share: dict[str, float] = field(default_factory=dict)  # of its region's pixels; {}: unknown
    environment_luminance: float = 0.5  # mean luminance of a linked environment at strength 1, untinted
    backdrop_luminance: float = 0.5  # the same of a linked backdrop that only the camera sees
    texture_luminance: dict[str, float] = field(default_factory=dict)  # of each material's linked base color
    values: dict[str, Values] = field(default_factory=dict)  # key -> current value, or the artist's if there is none
    picture: PictureStats | None = None  # of the image that these values give; None before the first one
    # copy of a material that the words need -> the objects that are to wear it, see `schema.material_copies`
    copies: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    _made: dict[Any, tuple[Vocabulary, Any]] = field(init=False, repr=False, compare=False, default_factory=dict)

    def made(self, make: Callable[[SceneDescription, Vocabulary], T], vocabulary: Vocabulary) -> T:
        """The object `make(self, vocabulary)`, which is made once and kept."""
        if make not in self._made or self._made[make][0] is not vocabulary:
            self._made[make] = vocabulary, make(self, vocabulary)
        made: T = self._made[make][1]
        return made

    def light(self, name: str) -> LightDescription:
        """The description of a light of the scene, or of an added one, by its name; an empty one for other names."""
        return self.lights.get(name) or self.added_lights.get(name) or LightDescription()


@dataclass(frozen=True)
class Attribute:
    """One look word of the prompt, bound to what it describes."""

    word: str  # as the prompt says it, with its intensity or negation: "very glossy", "no fog"
    entry: str  # name of the vocabulary entry, or of the color
    # "color", "finish", "material", "lighting", "atmosphere", "grade", "mood" or "setting"; "picture" for a reference
    # image, whose file is then the entry
    slot: str
    region: Region  # of the image
    kind: str = "subject"  # of what it describes: "subject", "surroundings", "sky", "light", "fog", ...
    strength: float = 1.0  # 1 as named; below for "slightly", above for "very"
    negated: bool = False  # "no", "without", "not"
    less: bool = False  # asks for less of its entry: "less fog". "Less glossy" has the entry matte: False
    owners: tuple[str, ...] = ()  # materials that are meant; empty for all of the region
    role: str = ""  # the lights that are meant: "key", "fill", "rim" or "others"; "" for light in general
    color: Values | None = None  # the named color, sRGB in [0, 1]; None unless the slot is "color"
    thing: str = ""  # what the prompt calls the thing that it describes: "teapot", "wall", "key light"
    # the mood or style word that stands for this one, as the prompt says it; "" when the prompt says this one itself
    cause: str = ""
    guess: bool = False  # Misspelled, and taken for the known word
    # how a material's own color is changed ("dark oak"): arguments of `color.shade`, one after the other
    shades: tuple[tuple[float, float, float, float], ...] = ()
    lights: tuple[str, ...] = ()  # lights that the words single out; of a glow "material/NAME"
    english: str = ""  # the word in English, where the prompt says it in another language
    place: tuple[int, int] | None = None  # start and end in a prompt of another language; else None
    phrases: tuple[int, ...] = ()  # numbers of lights that the prompt describes one by one
    look: int = field(default=-1, compare=False)  # number of the look word in the prompt, from 0; -1 without one

    @property
    def grades(self) -> bool:
        """True for a mood or a place that is about the grade alone, not about light."""
        return self.slot in ("mood", "setting") and self.kind == "tone"

    @property
    def part(self) -> Part:
        """The part of the image that the word describes: the sky, the subject, or all of it."""
        if self.kind == "sky":
            return "sky"
        return "picture" if self.region == "whole" else self.region

    @property
    def of_glows(self) -> bool:
        """True if it is about surfaces that glow, which count as lights."""
        return any(name.startswith(GLOW) for name in self.lights)

    @property
    def of_one_light(self) -> bool:
        """True if it is about particular lights, so that words about other lights do not concern it."""
        return bool(self.lights or self.role or self.owners)

    def is_of_another_light(self, other: Attribute) -> bool:
        """True if the prompt describes lights one by one, and this word and another are about different ones."""
        return bool(self.phrases and other.phrases) and {*self.phrases}.isdisjoint(other.phrases)


@dataclass
class PromptObject:
    """Something that the prompt describes, in the foreground or around it."""

    name: str  # "teapot", "wall"; "subject" or "surroundings" where the prompt names nothing
    region: Region  # "subject" or "surroundings"
    attributes: dict[str, str] = field(default_factory=dict)  # slot -> words: {"color": "teal"}
    materials: tuple[str, ...] = ()  # materials that it is made of; empty when no name in the scene matches


@dataclass(frozen=True)
class Candidate:
    """A possible target of a word."""

    name: str  # as `--target` takes it, see `schema.targets`
    probability: float  # by the reader's weights, in the prompt as a whole


@dataclass(frozen=True)
class PromptWord:
    """A word of the prompt, for reports: a look word with its target, or a word that is not used."""

    text: str  # as the prompt says it, with its intensity or negation: "very glossy"
    key: str  # what `--target` calls it: "glossy", or "red#2" where the prompt says it several times
    place: tuple[int, int] | None = None  # where it begins and ends in the prompt; None if unknown
    entry: str = ""  # its sense: name of the vocabulary entry, or of the color; "" where it is not used
    strength: float = 1.0  # 1 as named; below for "slightly", above for "very"
    negated: bool = False  # "no", "without", "not"
    target: str = NOT_USED  # name of what it describes, see `schema.targets`; "not used" where it is left out
    thing: str = ""  # the prompt's noun for the target: "cube"; "" if it has only the word
    confidence: float = 1.0  # probability of the target; 1 where the artist says so, or the scene lacks it
    # what it may describe, the target first, then the likeliest; empty for a word that is no look word
    candidates: tuple[Candidate, ...] = ()
    others: tuple[str, ...] = ()  # what else of the scene it can describe
    guess: str = ""  # the known word that it is taken for, where it is misspelled

    def row(self) -> dict[str, Any]:
        """The word for the report and `--json`: all fields but `others`."""
        return {name: value for name, value in asdict(self).items() if name != "others"}


@dataclass(frozen=True)
class SaidLink:
    """A passage of the prompt that says which objects a light is to light."""

    text: str  # the words, as the prompt has them
    only: bool  # whether it lights only these objects, or all but them
    objects: tuple[str, ...]
    role: str  # "key", "fill" or "rim", if the noun stands for a role of lights; else ""
    lights: tuple[str, ...] = ()  # names of the scene's lights that the noun names


@dataclass
class Parsed:
    """A prompt as read: its look words, bound to what they describe, and what else it says."""

    prompt: str  # the text, white space tidied
    objects: list[PromptObject] = field(default_factory=list)  # at least one for the subject
    attributes: list[Attribute] = field(default_factory=list)  # all look words found, in order
    ignored: list[str] = field(default_factory=list)  # words that could not be used, in the order of the text
    # misspelled word -> the known word, or the name in the scene, that it was taken for
    guesses: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)  # on how the prompt was read, a sentence each
    absent: tuple[str, ...] = ()  # nouns of look words that name nothing in the scene
    undone: bool = False  # whether some of it asks to add, move or remove objects
    protected: tuple[str, ...] = ()  # owners that are to stay: "material/Plaster", "light/Key", "world"
    links: tuple[SaidLink, ...] = ()  # its passages on the objects that lights are to light
    words: tuple[PromptWord, ...] = ()  # its look words and what is left out, in the order of the text
    unknown: VibeError | None = None  # says why nothing in it is understood; None if something is
