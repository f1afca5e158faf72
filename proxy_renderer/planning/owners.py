# SPDX-License-Identifier: Apache-2.0
"""Materials, lights and the world, as words mean them."""

from collections.abc import Mapping
from dataclasses import replace

from ..schema import Instance, Values
from ..words.lexicon.entries import OWNERS, Effect
from ..words.lexicon.vocabulary import Vocabulary
from ..words.names import is_detail, kind_of
from ..words.types import Attribute, Parsed, SceneDescription
from .scene_lights import SceneLights

_PART = 0.12  # materials on less of their region are parts: tyres, eyes, screws
_LIKE = 0.25  # where all are parts, share of the largest that those have which make it up: a shelf of a hundred books
_STAYS = "the prompt says that it stays"
_LOOK = ("base_color", "metallic", "roughness", "transmission")  # they tell small parts from large ones


class SceneMaterials:
    """The materials of a scene, with the share of its region's pixels that each covers, where known."""

    def __init__(self, instances: Mapping[str, Instance], shares: Mapping[str, float]) -> None:
        self._instances, self._shares = instances, shares

    def of_region(self, region: str) -> list[str]:
        """All materials of a region: "subject" or "surroundings"."""
        found = (i for i in self._instances.values() if i.parameter.group == "material" and i.role == region)
        return list(dict.fromkeys(i.owner for i in found))

    def meant(self, effect: Effect, attribute: Attribute) -> list[str]:
        """The materials on which an effect of a word acts."""
        region = attribute.region if effect.owner == "material" else effect.owner
        if effect.owner == "surroundings" and attribute.kind == "sky":
            return []
        if attribute.owners and region == attribute.region:
            names = self._whole(list(attribute.owners))
        else:
            names = self.of_region(region if region in ("subject", "surroundings") else "subject")
            if attribute.slot != "lighting":  # light falls on parts too: no part of a silhouette is lit
                names = self._whole(names)
        recolors = effect.name == "recolor"
        return [name for name in names if not recolors or self._is_recolored(name, effect, attribute)]

    def _is_recolored(self, name: str, effect: Effect, attribute: Attribute) -> bool:
        """Whether a word may gray what is then tinted: a surface, or a glow that gets a color itself."""
        glow = f"material/{name}/tint" not in self._instances
        if attribute.kind == "glow":
            return glow
        return not glow or (attribute.color is not None and effect.owner == "material")

    def _whole(self, names: list[str]) -> list[str]:
        """Of the materials of a thing those that make it up: "red car" means neither its tyres nor a screw.

        A small one that looks like a large one is no part of its own: the fender is as gray as the hood.
        """
        shares: dict[str, float] = {}
        for name in names:  # all of a kind, or none: not the one tyre that is seen best
            kind = kind_of(name)
            shares[kind] = shares.get(kind, 0.0) + self._shares.get(name, 1.0)
        made_up = [n for n in names if not is_detail(n)] or names
        least = _PART * sum(shares.values())
        large = [n for n in made_up if shares[kind_of(n)] >= least]
        most = max((shares[kind_of(n)] for n in made_up), default=0.0)
        large = large or [n for n in made_up if shares[kind_of(n)] >= _LIKE * most]
        looks = {look for n in large if (look := self._look(n))}
        return [n for n in made_up if n in large or self._look(n) in looks]

    def _look(self, name: str) -> tuple[Values, ...]:
        if f"material/{name}/base_color" not in self._instances:
            return ()
        values = (self._instances.get(f"material/{name}/{part}") for part in _LOOK)
        return tuple(tuple(round(v, 2) for v in i.value) if i else () for i in values)


BACKDROP = "world/backdrop_strength"  # there, if what the camera sees of the world is not what lights
_OF_BACKDROP = {"color": "backdrop_color", "tint": "backdrop_tint", "strength": "backdrop_strength"}
"""What the world's parameters are of its backdrop."""
SEEN, _SHED = ("surroundings", "sky"), ("share", "times", "gel")  # kinds: seen of it; modes: its light
SLIVER = 0.05  # of the surroundings: so little world counts as none


class Owners:
    """The instances that an effect of a word acts on."""

    def __init__(
        self, parsed: Parsed, instances: dict[str, Instance], scene: SceneDescription, vocabulary: Vocabulary
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
        # surroundings are no world where an object is named, or a sky
        elsewhere = attribute.owners or any(a.kind == "sky" for a in self._parsed.attributes)
        if attribute.kind == "surroundings" and effect.mode != "times" and elsewhere:
            return []
        if own and (effect.mode == "shown" or attribute.kind in SEEN):
            return [own]
        return [effect.name, own] if own and effect.mode not in _SHED else [effect.name]


def protected(instance: Instance, parsed: Parsed) -> Instance:
    """A parameter, locked where the prompt says that its owner stays as it is."""
    owner = f"{instance.parameter.group}/{instance.owner}".rstrip("/")
    return replace(instance, locked=_STAYS) if owner in parsed.protected and not instance.locked else instance
