# SPDX-License-Identifier: Apache-2.0
"""The records of labeled sentences: scenes without geometry, look words, and what they describe."""

from __future__ import annotations

from dataclasses import dataclass, field

SCENE_KINDS = (
    "product", "interior", "landscape", "character", "car", "food", "architecture", "abstract",
)  # fmt: skip
SENTENCE_KINDS = (
    "list", "prose", "short", "long", "negation", "comparison", "exception", "things", "lamps", "time", "correction",
    "figurative", "typing", "wish",
)  # fmt: skip
TARGETS = (
    "subject", "surroundings", "others", "light", "key", "fill", "rim", "sky", "air", "picture", "none",
)  # fmt: skip
"""Those that need no name of the scene."""
LIGHT_TYPES = ("POINT", "SPOT", "AREA", "SUN")
ROLES = ("key", "fill", "rim")


@dataclass(frozen=True)
class LabeledLight:
    """A light of a labeled scene.

    Attributes:
        name: As the artist called it.
        type: One of `LIGHT_TYPES`.
        role: One of `ROLES`.
        turn: Degrees around the subject: 0 behind the camera, 90 on its right, 180 behind the subject.
        lights: Objects that it mainly lights; none where nothing is said.
    """

    name: str
    type: str
    role: str
    turn: float
    lights: tuple[str, ...] = ()


@dataclass(frozen=True)
class LabeledScene:
    """Targets that words may mean in a scene; it has no geometry.

    Attributes:
        name: Unique in its folder.
        kind: One of `SCENE_KINDS`.
        subject: Names of the objects that the picture is about.
        objects: Visible object -> its materials.
        collections: Collection -> objects in it.
        parents: Object -> its parent's name.
        places: Object -> x (-1 left, 1 right), y (0 near, 1 far), and size as a share of the picture's width.
        lights: Its lights.
        glows: Materials that emit light.
        sky: Whether the camera sees the world.
    """

    name: str
    kind: str
    subject: tuple[str, ...]
    objects: dict[str, tuple[str, ...]]
    collections: dict[str, tuple[str, ...]] = field(default_factory=dict)
    parents: dict[str, str] = field(default_factory=dict)
    places: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    lights: tuple[LabeledLight, ...] = ()
    glows: tuple[str, ...] = ()
    sky: bool = False

    @property
    def materials(self) -> tuple[str, ...]:
        """All of them, in the order of the objects."""
        return tuple(dict.fromkeys(name for worn in self.objects.values() for name in worn))

    def materials_of(self, region: str) -> frozenset[str]:
        """Those of the "subject", or of its "surroundings"; one that both wear is the subject's."""
        mine = frozenset(name for thing in self.subject for name in self.objects[thing])
        return mine if region == "subject" else frozenset(self.materials) - mine


@dataclass(frozen=True)
class LabelTarget:
    """Targets of a look word.

    Attributes:
        kind: One of `TARGETS`, or "materials" or "lights" for named ones.
        names: Of the materials or lights; a glow counts as a light by its material's name.
    """

    kind: str
    names: frozenset[str] = frozenset()

    def __str__(self) -> str:
        prefix = "light:" if self.kind == "lights" else ""
        return " + ".join(prefix + name for name in sorted(self.names)) or self.kind


@dataclass(frozen=True)
class LookWord:
    """A labeled look word.

    Attributes:
        text: As it stands in the sentence.
        start: Place of its first character in the sentence.
        targets: What it describes; several where all of them are right, the best one first.
    """

    text: str
    start: int
    targets: tuple[LabelTarget, ...]

    @property
    def end(self) -> int:
        """Place after its last character."""
        return self.start + len(self.text)

    @property
    def target(self) -> str:
        """As it is written in the file."""
        return " | ".join(map(str, self.targets))


@dataclass(frozen=True)
class LabeledSentence:
    """A sentence with its look words, in the order of the text.

    Attributes:
        scene: What it is about.
        kind: How it is written: one of `SENTENCE_KINDS`.
        text: As an artist would type it.
        words: All that asks for a look, or for something that values cannot do.
    """

    scene: LabeledScene
    kind: str
    text: str
    words: tuple[LookWord, ...]
