# SPDX-License-Identifier: Apache-2.0
"""From the target of a word to the materials, lights and parameters of the world that its effects change."""

from collections.abc import Mapping
from dataclasses import replace

from ..goals.wish import Wish
from ..schema import Instance, Values
from ..words.lexicon.entries import OWNERS, Effect
from ..words.names import is_detail, kind_of
from ..words.types import GLOW, Attribute, Parsed, SceneDescription
from .light_levels import facing_radiance

_OF_GLOWS = {"power": "emission", "color": "emission_color", "temperature": "emission_color"}
"""Parameter of a light -> parameter of a glowing material; glows have no position or size to change."""


class SceneLights:
    """The lights of a scene by role, and the materials that glow enough to count as lights.

    Attributes:
        key: Names of the key lights, or of the light brightest on the subject if no light has that role. If there are
            glows: only the brightest one of these lights and the glows.
        rim: Names of the rim lights; without any, the light most behind the subject that is no key.
        fill: Names of the fill lights, and of all glows that are no key.
        lamps: Names of all lights, without glows.
        glows: Glowing materials that count as lights, as "material/NAME".
    """

    def __init__(self, instances: dict[str, Instance], scene: SceneDescription) -> None:
        self._instances, self._scene = instances, scene
        self.lamps = list(dict.fromkeys(i.owner for i in instances.values() if i.parameter.group == "light"))
        # Glows that give the subject a noticeable share of all light; dials and diodes do not.
        least = 0.15 * max(self._radiance(), 1e-6)
        glows = (f"{GLOW}{material}" for material in scene.emitters)
        self.glows = [name for name in glows if self._radiance(name) > least]
        own = self.of_role("key")
        self.key = own
        if self.glows or not own:
            self.key = sorted([*(own or self.lamps), *self.glows], key=self._radiance, reverse=True)[:1]
        others = [n for n in self.lamps if n not in self.key]
        unassigned = [n for n in others if n not in self.of_role("fill")] or others
        angles = {
            i.owner: i.value[0] / i.reference for i in instances.values() if i.parameter.family == "light/azimuth"
        }
        turns = {n: (angles.get(n, 0.0) - scene.camera_azimuth) % 360.0 for n in unassigned}
        behind = sorted(unassigned, key=lambda n: abs(turns[n] - 180.0))
        self.rim = [n for n in self.of_role("rim") if n not in self.key] or behind[:1]
        self.fill = [n for n in [*self.of_role("fill"), *self.glows] if n not in self.key]

    @property
    def every(self) -> list[str]:
        """Names of all lights and glows."""
        return [*self.lamps, *self.glows]

    def of_role(self, role: str) -> list[str]:
        """Names of the lights that have a role in the scene: "key", "fill" or "rim"."""
        playing = {i.owner for i in self._instances.values() if i.role == role}
        return [name for name in self.lamps if name in playing]

    def values(self, effect: Effect, attribute: Attribute) -> list[Instance]:
        """Instances of lights that an effect of a word changes; for a glow, the corresponding ones of its material."""
        glowing = _OF_GLOWS.get(effect.name)
        keys = [
            f"{light}/{glowing}" if light.startswith(GLOW) else f"light/{light}/{effect.name}"
            for light in self.targets(effect, attribute)
            if glowing or not light.startswith(GLOW)
        ]
        return [self._instances[key] for key in keys if key in self._instances]

    def targets(self, effect: Effect, attribute: Attribute) -> list[str]:
        """The names of the lights and glows that an effect of a word changes; a glow is "material/NAME"."""
        owner, role = effect.owner, attribute.role
        own = list(attribute.lights)
        if own and owner not in ("rim", "fill"):
            if owner == "others":
                return self._but(own)
            turned = owner != "lights" and effect.name in ("azimuth", "elevation")
            return own[:1] if turned else own
        if owner == "others":
            return self._but(self._with_role(role if role in ("rim", "fill") else "key"))
        if owner not in ("light", "lights"):
            return self._with_role(owner)
        if role:
            return self._with_role(role)
        return self.key if owner == "light" else self.every

    def _with_role(self, role: str) -> list[str]:
        own = {"key": self.key, "rim": self.rim, "fill": self.fill}
        return own[role] if role in own else self._but(self.key)

    def _but(self, names: list[str]) -> list[str]:
        return [name for name in self.every if name not in names]

    def _radiance(self, *lights: str) -> float:
        """Radiance of a white surface that faces the named lights and glows, or all, at the artist's values."""
        return facing_radiance(self._instances, self._scene, lambda i: i.value, lights or None)


class SceneMaterials:
    """The materials of a scene. `shares`: material -> the share that it covers of its region's pixels, if known."""

    def __init__(self, instances: Mapping[str, Instance], shares: Mapping[str, float]) -> None:
        self._instances, self._shares = instances, shares

    def of_region(self, region: str) -> list[str]:
        """Names of all materials of a region: "subject" or "surroundings"."""
        found = (i for i in self._instances.values() if i.parameter.group == "material" and i.role == region)
        return list(dict.fromkeys(i.owner for i in found))

    def targets(self, effect: Effect, attribute: Attribute) -> list[str]:
        """The names of the materials that an effect of a word changes."""
        region = attribute.region if effect.owner == "material" else effect.owner
        if effect.owner == "surroundings" and attribute.kind == "sky":
            return []
        if attribute.owners and region == attribute.region:
            names = self._whole(list(attribute.owners))
        else:
            names = self.of_region(region if region in ("subject", "surroundings") else "subject")
            if attribute.slot != "lighting":  # light falls on small parts, too: all of a silhouette is dark
                names = self._whole(names)
        if effect.name != "recolor":
            return names
        # `recolor` grays a texture before it is tinted. Words about glows gray glows, which have no `tint`; all other words gray
        # surfaces, and glows only if they give them a color.
        glows = [name for name in names if f"material/{name}/tint" not in self._instances]
        if attribute.kind == "glow":
            return glows
        return [n for n in names if n not in glows or (attribute.color is not None and effect.owner == "material")]

    def _whole(self, names: list[str]) -> list[str]:
        """The main ones of an object's materials, and small ones that look alike: "red car" does not mean its tires."""
        shares: dict[str, float] = {}
        for name in names:  # by kind, so that all four tires are treated alike
            kind = kind_of(name)
            shares[kind] = shares.get(kind, 0.0) + self._shares.get(name, 1.0)
        made_up = [n for n in names if not is_detail(n)] or names
        least = 0.12 * sum(shares.values())  # tires, eyes and screws have less
        large = [n for n in made_up if shares[kind_of(n)] >= least]
        most = max((shares[kind_of(n)] for n in made_up), default=0.0)
        # if all are small: a shelf of a hundred books
        large = large or [n for n in made_up if shares[kind_of(n)] >= 0.25 * most]
        looks = {look for n in large if (look := self._look(n))}
        return [n for n in made_up if n in large or self._look(n) in looks]

    def _look(self, name: str) -> tuple[Values, ...]:
        if f"material/{name}/base_color" not in self._instances:
            return ()
        parts = "base_color", "metallic", "roughness", "transmission"
        values = (self._instances.get(f"material/{name}/{part}") for part in parts)
        return tuple(tuple(round(v, 2) for v in i.value) if i else () for i in values)


BACKDROP = "world/backdrop_strength"  # exists if the camera sees another background than the one that lights


class Owners:
    """Finds the instances that an effect of a word changes."""

    def __init__(self, parsed: Parsed, instances: dict[str, Instance], scene: SceneDescription) -> None:
        self._parsed, self._instances, self._world_share = parsed, instances, scene.world_share
        self.materials = SceneMaterials(instances, scene.material_share)
        self.lights = SceneLights(instances, scene)

    def of(self, effect: Effect, attribute: Attribute) -> list[Instance]:
        """The instances of an effect's family that belong to the target of a word; [] if the scene has none."""
        group = OWNERS[effect.owner]
        if group == "light":
            return self.lights.values(effect, attribute)
        if group == "world":
            # The world's parameter (warm light), its backdrop's (a white background), or both (a night)
            parted = BACKDROP in self._instances and effect.name in ("color", "tint", "strength")
            own = f"backdrop_{effect.name}" if parted else ""
            # If the prompt names materials or a sky, words for the surroundings do not mean the world.
            elsewhere = attribute.owners or any(a.kind == "sky" for a in self._parsed.attributes)
            if attribute.kind == "surroundings" and effect.mode != "times" and elsewhere:
                return []
            seen = bool(own) and (effect.mode == "shown" or attribute.kind in ("surroundings", "sky"))
            of_light = effect.mode in ("share", "times", "gel")  # on the world's light alone
            names = [own] if seen else [effect.name] if of_light else [effect.name, own]
        elif group == "material":
            names = [f"{material}/{effect.name}" for material in self.materials.targets(effect, attribute)]
        else:
            names = [effect.name]
        keys = (f"{group}/{name}" for name in names)
        return [self._instances[key] for key in keys if key in self._instances]

    def gives_backdrop(self, wish: Wish, effect: Effect) -> bool:
        """True if a word gives the visible background a color of its own: "cream background"."""
        attribute = wish.attribute
        colored = attribute.kind == "surroundings" and attribute.color and not attribute.cause
        return bool(colored) and any(i.key.startswith("world/backdrop_") for i in self.of(effect, attribute))

    def world_is_hidden(self) -> bool:
        """True if surfaces fill nearly all of the camera's view, so that the world is not visible."""
        share = self._world_share
        return share is not None and share < 0.05 and bool(self.materials.of_region("surroundings"))


def protected(instance: Instance, parsed: Parsed) -> Instance:
    """The instance, which is locked if the prompt says that its owner stays as it is."""
    owner = f"{instance.parameter.group}/{instance.owner}".rstrip("/")
    stays = owner in parsed.protected and not instance.locked
    return replace(instance, locked="the prompt says that it stays") if stays else instance
