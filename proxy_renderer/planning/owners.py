# SPDX-License-Identifier: Apache-2.0
"""Who is meant: the instances in a scene that a word's effect acts on."""

from __future__ import annotations

from ..prompt.lexicon.entries import OWNERS, Effect
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.types import Attribute, Parsed, SceneDescription
from ..schema import Instance
from .lights.choice import SceneLights
from .materials import SceneMaterials

BACKDROP = "world/backdrop_strength"
"""There, if what the camera sees of the world is not what lights."""
_OF_BACKDROP = {"color": "backdrop_color", "tint": "backdrop_tint", "strength": "backdrop_strength"}
"""What the world's parameters are of its backdrop."""
SEEN, _SHED = ("surroundings", "sky"), ("share", "times", "gel")
"""Kinds of words that are about what is seen of the world, and modes of effects that are about its light."""
SLIVER = 0.05  # of the surroundings: so little world counts as none


class Owners:
    """Materials, lights and the world, as words mean them.

    Attributes:
        materials: The scene's materials.
        lights: The scene's lights, and what glows.
    """

    def __init__(
        self,
        parsed: Parsed,
        instances: dict[str, Instance],
        scene: SceneDescription,
        vocabulary: Vocabulary,
    ) -> None:
        self._parsed, self._instances, self._world_share = parsed, instances, scene.world_share
        self.materials = SceneMaterials(instances, scene.material_share)
        self.lights = SceneLights(parsed, instances, scene, vocabulary)

    def of(self, effect: Effect, attribute: Attribute) -> list[Instance]:
        """The instances of an effect's family that an attribute means; may be empty."""
        group = OWNERS[effect.owner]
        if group == "light":
            return self.lights.values(effect, attribute)
        if group == "world":
            names = self._of_world(effect, attribute)
        elif group == "material":
            names = [f"{material}/{effect.name}" for material in self.materials.meant(effect, attribute)]
        else:
            names = [effect.name]
        keys = (f"{group}/{name}" for name in names)
        return [self._instances[key] for key in keys if key in self._instances]

    def world_is_hidden(self) -> bool:
        """Whether surfaces fill all that the camera sees."""
        share = self._world_share
        return share is not None and share < SLIVER and bool(self.materials.of_region("surroundings"))

    def _of_world(self, effect: Effect, attribute: Attribute) -> list[str]:
        """The world's parameter, its backdrop's, or both: a white background is seen, warm light is shed, a night is both."""
        own = _OF_BACKDROP.get(effect.name) if BACKDROP in self._instances else None
        if not self._concerns_world(effect, attribute):
            return []
        if own and (effect.mode == "shown" or attribute.kind in SEEN):
            return [own]
        return [effect.name, own] if own and effect.mode not in _SHED else [effect.name]

    def _concerns_world(self, effect: Effect, attribute: Attribute) -> bool:
        """Whether a word about surroundings means the world too: not if it names a thing, or a sky is named."""
        if attribute.kind != "surroundings" or effect.mode == "times":
            return True
        return not attribute.owners and not any(a.kind == "sky" for a in self._parsed.attributes)
