# SPDX-License-Identifier: Apache-2.0
"""A labeled sentence as the real reader understands it: what of the scene each attribute reaches."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass, replace

from lab.train.sentences.labels import LabeledScene
from lab.train.sentences.stand_in import STANDBY, SceneStandIn, stand_in
from proxy_renderer.goals.resolve import goals_of
from proxy_renderer.goals.wish import wishes_of
from proxy_renderer.planning.owners import Owners
from proxy_renderer.planning.support import missing_lights
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.entries import OWNERS, Effect
from proxy_renderer.words.lexicon.vocabulary import Vocabulary
from proxy_renderer.words.model import FactWeights
from proxy_renderer.words.parser import parse
from proxy_renderer.words.types import GLOW, Attribute, Parsed

_MATTER = ("finish", "material", "color")


@dataclass(frozen=True)
class Reach:
    """Parts of a scene that an attribute changes.

    Attributes:
        attribute: As the reader bound it.
        materials: Names of the materials that it paints.
        lights: Names of lights, and of glowing materials that count as lights.
        parts: Which of "world", "volume" and "film" it changes.
        touched: Groups of parameters that it changes in any way, weakly too: "light", "world", "film".
        directs: Whether it says where light comes from.
    """

    attribute: Attribute
    materials: frozenset[str]
    lights: frozenset[str]
    parts: frozenset[str]
    touched: frozenset[str]
    directs: bool = False

    @property
    def particular(self) -> bool:
        """True if it singles out materials or lights, instead of a whole region or all light."""
        return bool(self.attribute.owners or self.attribute.lights or self.attribute.role)

    def __str__(self) -> str:
        """For people: "CarPaint", "light:Key + light:Sun", "world + film"; the kind of thing where it changes nothing."""
        lights = (f"light:{name}" for name in sorted(self.lights))
        return " + ".join((*sorted(self.materials), *lights, *sorted(self.parts))) or self.attribute.kind


@dataclass(frozen=True)
class SentenceReading:
    """The reader's result for a sentence.

    Attributes:
        reaches: Of its attributes, in the order of the text; those that a mood stands for are left out.
        roles: Role -> the scene's lights that have it.
        seconds: That reading and binding took.
        error: Why it could not be read; "" if it could.
    """

    reaches: tuple[Reach, ...]
    roles: dict[str, frozenset[str]]
    seconds: float
    error: str = ""


def read(text: str, scene: LabeledScene, vocabulary: Vocabulary, weights: FactWeights | None = None) -> SentenceReading:
    """Reads a sentence about a scene, and finds out what its attributes reach.

    Args:
        weights: Of the reader; those that are shipped if None.
    """
    whole = stand_in(scene)
    start = time.perf_counter()
    try:
        parsed = parse(text, whole.scene, vocabulary, weights)
    except VibeError as error:
        return SentenceReading((), {}, time.perf_counter() - start, error.message)
    own = {light.name: light.role for light in scene.lights}
    names = missing_lights(goals_of(parsed, vocabulary), whole.instances, whole.scene, STANDBY)
    binding = _Binding(parsed, whole.with_lights(names), vocabulary)
    reaches = tuple(map(binding.reach, (a for a in parsed.attributes if not a.cause)))
    seconds = time.perf_counter() - start
    lights = own | {name: STANDBY[name] for name in names}
    roles = {r: frozenset(n for n, role in lights.items() if role == r) for r in ("key", "fill", "rim")}
    if not roles["key"]:
        roles["key"] = _plain(binding.owners.lights.key)
    return SentenceReading(reaches, roles, seconds)


class _Binding:
    """The real assignment of a sentence's words to materials and lights."""

    def __init__(self, parsed: Parsed, scene: SceneStandIn, vocabulary: Vocabulary) -> None:
        self.vocabulary = vocabulary
        self.owners = Owners(parsed, scene.instances, scene.scene)

    def reach(self, attribute: Attribute) -> Reach:
        """Parts that an attribute changes; negated words reach what they would change."""
        reached = [
            (OWNERS[effect.owner], instance.owner)
            for effect in self._effects(attribute)
            for instance in self.owners.of(effect, attribute)
        ]
        materials, lights = (_plain(n for g, n in reached if g == group) for group in ("material", "light"))
        parts = frozenset(group for group, _ in reached) - {"material", "light"}
        effects = self._wished(attribute)
        touched = frozenset(OWNERS[effect.owner] for effect in effects)
        directs = any(e.name in ("azimuth", "elevation") and not e.weak for e in effects)
        return Reach(attribute, materials, lights, parts, touched, directs)

    def _wished(self, attribute: Attribute) -> list[Effect]:
        """All that it does."""
        return [e for wish in wishes_of([attribute], self.vocabulary) for e in wish.effects]

    def _effects(self, attribute: Attribute) -> list[Effect]:
        """Its first wish; of a word about matter, what it does to that matter."""
        said = replace(attribute, negated=False)
        effects = self._wished(said)
        strong = [e for e in effects if not e.weak] or effects
        if attribute.slot in _MATTER and not attribute.color:
            return [e for e in strong if e.owner == "material"] or strong
        return strong


def _plain(names: Iterable[str]) -> frozenset[str]:
    return frozenset(name.removeprefix(GLOW) for name in names)
