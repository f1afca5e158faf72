# SPDX-License-Identifier: Apache-2.0
"""Who is meant: the instances in a scene that a word's effect acts on."""

from __future__ import annotations

from ..prompt.lexicon.entries import OWNERS, Effect
from ..prompt.lexicon.vocabulary import Vocabulary
from ..prompt.names import is_detail, kind_of
from ..prompt.types import GLOW, Attribute, Parsed
from ..schema import Instance, Values
from .lights.facing import facing_radiance
from .lights.meant import KnownLight, assigned, named
from .types import PlanContext

_PART = 0.12  # materials on less of their region are parts: tyres, eyes, screws
_LIKE = 0.25  # where all are parts, share of the largest that those have which make it up: a shelf of a hundred books
_SHARE = 0.15  # of the light on the subject from which a glow counts as a light of the scene
_LOOK = ("base_color", "metallic", "roughness", "transmission")
"""Values of a material by which small parts are told from large ones."""
_OF_GLOWS = {"power": "emission", "color": "emission_color", "temperature": "emission_color"}
"""What the parameters of lights are of glowing materials; they have neither place nor size to change."""
_PLACES = ("azimuth", "elevation", "distance", "size", "angle")
BACKDROP = "world/backdrop_strength"
"""There, if what the camera sees of the world is not what lights."""
_OF_BACKDROP = {"color": "backdrop_color", "tint": "backdrop_tint", "strength": "backdrop_strength"}
"""What the world's parameters are of its backdrop."""
SEEN, _SHED = ("surroundings", "sky"), ("share", "times", "gel")
"""Kinds of words that are about what is seen of the world, and modes of effects that are about its light."""
SLIVER = 0.05  # of the surroundings: so little world counts as none


class Owners:
    """Materials by region and lights by role.

    Attributes:
        key: Names of the key lights; the one that is brightest on the subject where no light has that role.
        rim: Names of the rim lights; else the one nearest to behind the subject, if there are several.
        fill: Names of the fill lights.
        lights: All lights.
        glows: Glowing materials that light the scene as lights do, as "material/NAME"; they may be key and fill too.
        lamps: The lights that the prompt tells apart: number -> names, of which the first is meant above all.
    """

    def __init__(
        self, parsed: Parsed, instances: dict[str, Instance], context: PlanContext, vocabulary: Vocabulary
    ) -> None:
        self.parsed, self.instances, self.context = parsed, instances, context
        self.vocabulary = vocabulary
        self.lights = list(dict.fromkeys(i.owner for i in instances.values() if i.parameter.group == "light"))
        self.glows = self._glowing()
        self.key = self._key()
        self.rim = [n for n in self.of_role("rim") if n not in self.key] or self._nearest_behind()
        self.fill = [n for n in [*self.of_role("fill"), *self.glows] if n not in self.key]
        self.lamps = assigned(parsed.attributes, self._known_lights(), vocabulary)

    def of(self, effect: Effect, attribute: Attribute) -> list[Instance]:
        """The instances of an effect's family that an attribute means; may be empty."""
        group = OWNERS[effect.owner]
        if group == "material":
            names = self._materials(effect, attribute)
            if effect.name == "recolor":
                names = [name for name in names if self._is_recolored(name, effect, attribute)]
        elif group == "light":
            return self._light_values(effect.name, self._lights(effect, attribute))
        elif group == "world":
            return self._world_values(effect, attribute) if self._concerns(effect, attribute) else []
        else:
            names = [""]
        keys = (f"{group}/{name}/{effect.name}" if name else f"{group}/{effect.name}" for name in names)
        return [self.instances[key] for key in keys if key in self.instances]

    # ---- materials

    def materials(self, region: str) -> list[str]:
        """All materials of a region."""
        found = (i for i in self.instances.values() if i.parameter.group == "material" and i.role == region)
        return list(dict.fromkeys(i.owner for i in found))

    def _materials(self, effect: Effect, attribute: Attribute) -> list[str]:
        region = effect.owner if effect.owner != "material" else attribute.region
        if effect.owner == "surroundings" and attribute.kind == "sky":
            return []
        if attribute.owners and region == attribute.region:
            return self._whole(list(attribute.owners))
        names = self.materials(region if region in ("subject", "surroundings") else "subject")
        if attribute.slot == "lighting":  # light falls on parts too: no part of a silhouette is lit
            return names
        return self._whole(names)

    def _is_recolored(self, name: str, effect: Effect, attribute: Attribute) -> bool:
        """Whether a word may gray what is then tinted: a surface, or a glow that gets a color itself."""
        glow = f"material/{name}/tint" not in self.instances
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
            shares[kind] = shares.get(kind, 0.0) + self.context.material_share.get(name, 1.0)
        made_up = [n for n in names if not is_detail(n)] or names
        least = _PART * sum(shares.values())
        large = [n for n in made_up if shares[kind_of(n)] >= least]
        most = max((shares[kind_of(n)] for n in made_up), default=0.0)
        large = large or [n for n in made_up if shares[kind_of(n)] >= _LIKE * most]
        looks = {look for n in large if (look := self._look(n))}
        return [n for n in made_up if n in large or self._look(n) in looks]

    def _look(self, name: str) -> tuple[Values, ...]:
        """What a material of one color looks like; nothing for a textured one."""
        if f"material/{name}/base_color" not in self.instances:
            return ()
        values = (self.instances.get(f"material/{name}/{part}") for part in _LOOK)
        return tuple(tuple(round(v, 2) for v in i.value) if i else () for i in values)

    def world_is_hidden(self) -> bool:
        """Whether surfaces fill all that the camera sees."""
        share = self.context.world_share
        return share is not None and share < SLIVER and bool(self.materials("surroundings"))

    def _concerns(self, effect: Effect, attribute: Attribute) -> bool:
        """Whether a word about surroundings means the world too: not if it names a thing, or a sky is named."""
        if effect.owner != "world" or attribute.kind != "surroundings" or effect.mode == "times":
            return True
        return not attribute.owners and not any(a.kind == "sky" for a in self.parsed.attributes)

    def _world_values(self, effect: Effect, attribute: Attribute) -> list[Instance]:
        """The world's parameter, its backdrop's, or both: a white background is seen, warm light is shed, a night is both."""
        names = [effect.name]
        if BACKDROP in self.instances and (own := _OF_BACKDROP.get(effect.name)):
            seen = effect.mode == "shown" or attribute.kind in SEEN
            shed = effect.mode in _SHED
            names = [own] if seen else names if shed else [*names, own]
        return [i for name in names if (i := self.instances.get(f"world/{name}"))]

    # ---- lights

    def _light_values(self, name: str, lights: list[str]) -> list[Instance]:
        """The instances of a light's parameter; of a glow, those that stand for it."""
        glowing = _OF_GLOWS.get(name)
        keys = [
            f"{light}/{glowing}" if light.startswith(GLOW) else f"light/{light}/{name}"
            for light in lights
            if glowing or not light.startswith(GLOW)
        ]
        return [self.instances[key] for key in keys if key in self.instances]

    def _glowing(self) -> list[str]:
        """Materials that light the subject with a share of all light that is seen; dials and diodes do not."""

        def bright(*light: str) -> float:
            return facing_radiance(self.instances, self.context, lambda i: i.value, light or None)

        least = _SHARE * max(bright(), 1e-6)
        return [name for name in (f"material/{m}" for m in self.context.glows) if bright(name) > least]

    def _key(self) -> list[str]:
        """The light that has the role, or the brightest; a glow that is brighter takes its place."""
        lamps = self.of_role("key")
        if not self.glows:
            return lamps or self._brightest(self.lights)
        return self._brightest([*(lamps or self.lights), *self.glows])

    def _lights(self, effect: Effect, attribute: Attribute) -> list[str]:
        owner, role = effect.owner, attribute.role
        if effect.name in _PLACES and not set(self.key) & set(self.lights):
            return [] if role or owner in ("rim", "fill", "others") else self._brightest(self.lights)
        if (own := self._meant(attribute)) is not None:
            if owner in ("light", "key", "lights"):
                return own[:1] if owner != "lights" and effect.name in ("azimuth", "elevation") else own
            if owner == "others":
                spoken_of = {*own, *(name for names in self.lamps.values() for name in names)}
                return [name for name in (*self.lights, *self.glows) if name not in spoken_of]
        meant = {"key": self.key, "rim": self.rim, "fill": self.fill, "others": self._others("key")}.get(role)
        if owner == "light":
            return self.key if meant is None else meant
        if owner == "lights":
            return [*self.lights, *self.glows] if meant is None else meant
        if owner == "others":
            return self._others(role)
        return {"key": self.key, "rim": self.rim, "fill": self.fill}[owner]

    def _meant(self, attribute: Attribute) -> list[str] | None:
        """The lights that a word is said of, where the prompt tells several apart or calls one by its name."""
        if attribute.lights:
            return list(attribute.lights)
        if attribute.lamp:
            return self.lamps[attribute.lamp]
        if attribute.role or attribute.cause or attribute.kind not in ("light", "subject", "surroundings"):
            return None
        return named(attribute.thing, self._known_lights(), self.vocabulary)

    def _known_lights(self) -> list[KnownLight]:
        """All lights, the key first and those that are added for the words last."""
        order = {name: place for place, name in enumerate(self.key)}
        added = self.context.added_lights
        names = sorted((*self.lights, *self.glows), key=lambda n: (n in added, order.get(n, len(order))))
        return [
            self._known_glow(name)
            if name in self.glows
            else KnownLight(
                name,
                next((r for r in ("key", "fill", "rim") if name in self.of_role(r)), ""),
                (name, self.context.light_types.get(name, "")),
                (self._value(name, "azimuth") or 0.0) - self.context.camera_azimuth,
                name in added,
            )
            for name in names
        ]

    def _known_glow(self, name: str) -> KnownLight:
        material = name.removeprefix(GLOW)
        glow = self.context.glows[material]
        role = "key" if name in self.key else "fill"
        return KnownLight(name, role, (material, *glow.objects), glow.azimuth - self.context.camera_azimuth)

    def _others(self, role: str) -> list[str]:
        own = {"rim": self.rim, "fill": self.fill}.get(role, self.key)
        return [name for name in (*self.lights, *self.glows) if name not in own]

    def of_role(self, role: str) -> list[str]:
        """The lights that have a role in the scene."""
        return [
            n for n in self.lights if any(i.owner == n and i.role == role for i in self.instances.values())
        ]

    def _value(self, light: str, name: str) -> float | None:
        instance = self.instances.get(f"light/{light}/{name}")
        return instance.value[0] / instance.reference if instance else None

    def _brightest(self, lights: list[str]) -> list[str]:
        def bright(light: str) -> float:
            return facing_radiance(self.instances, self.context, lambda i: i.value, (light,))

        return [max(lights, key=bright)] if lights else []

    def _nearest_behind(self) -> list[str]:
        """The light that is most behind the subject, seen from the camera; never the key."""

        def frontal(light: str) -> float:
            turned = (self._value(light, "azimuth") or 0.0) - self.context.camera_azimuth
            return abs((turned - 180 + 180) % 360 - 180)

        others = [n for n in self.lights if n not in self.key]
        unassigned = [n for n in others if n not in self.of_role("fill")] or others
        return [min(unassigned, key=frontal)] if unassigned else []
