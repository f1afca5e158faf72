# SPDX-License-Identifier: Apache-2.0
"""Names of targets, as `--target` takes them: "Cup + Table", "key light", "image"."""

from __future__ import annotations

from collections.abc import Collection

from ...schema.targets import NAME_OF, joined
from ..types import GLOW, Attribute, SceneDescription
from .targets import MATTER, ROLES, Target

_MOST = 8  # names of one target: more are not worth reading
_KINDS = {"light": "light", "fog": "air", "sky": "sky", "shadow": "shadow", "highlight": "highlight"}
"""Kind of thing -> kind of target, where that is not a region."""
_REGIONS = {"subject": "subject", "surroundings": "surroundings"}


def target_name(target: Target, scene: SceneDescription) -> str:
    """The name of something that a word may describe; "" where it has none."""
    if target.names and target.kind not in ROLES:
        return _called(target.names, scene, is_matter=target.kind in MATTER)
    return NAME_OF.get(target.kind, "")


def described_name(attribute: Attribute, scene: SceneDescription) -> str:
    """The name of what an attribute describes."""
    names = _called(attribute.lights, scene, is_matter=False) if attribute.lights else ""
    names = names or (_called(attribute.owners, scene, is_matter=True) if attribute.owners else "")
    kind = attribute.role or _KINDS.get(attribute.kind) or _REGIONS.get(attribute.region, "picture")
    return names or NAME_OF.get(kind, "lights" if attribute.role else "image")


def glow_name(material: str) -> str:
    """The name of what a material that glows lights, as that of a light."""
    return f"glow of {material}"


def _called(names: Collection[str], scene: SceneDescription, is_matter: bool) -> str:
    """Lights by their names; materials by the objects that wear nothing else, as far as these wear all of them."""
    if not is_matter:
        called = [name for name in scene.lights if name in names]
        called += [glow_name(name) for name in scene.glows if GLOW + name in names]
    else:
        objects = [o for o, worn in scene.object_materials.items() if worn and {*worn} <= {*names}]
        worn = {m for o in objects for m in scene.object_materials[o]}
        called = objects if worn == {*names} else [m for m in scene.materials if m in names]
    return joined(sorted(called)) if len(called) <= _MOST else ""
