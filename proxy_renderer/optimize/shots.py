# SPDX-License-Identifier: Apache-2.0
"""Shots that share a look: several cameras, frames or scenes, and one vector of values for all of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import torch
from torch import Tensor

from ..claims.claim import ClaimSet
from ..claims.measures.picture import MeasuredPicture
from ..planning.types import Plan
from ..scene import SceneData
from ..schema import GROUPS, Instance, VibeError, labels, matches
from ..schema.messages import Options
from .anchoring import Anchoring, PictureSource
from .drawing import chosen_values, draw
from .vector import ParameterVector

if TYPE_CHECKING:
    from ..guidance.guide import Guidance
    from ..render.cycles.correction import Correction
    from ..render.gbuffer import GBuffer
    from ..render.proxy import Proxy, Render

MOVES = "it changes from shot to shot in your scene"


@dataclass(frozen=True)
class ShotInput:
    """What there is to know of a shot before the loop.

    Attributes:
        scene: As its camera sees it at its frame.
        source: Of Cycles' pictures of it; None for none.
        file: Names its .blend: what differs within one .blend is animated.
    """

    scene: SceneData
    source: PictureSource | None = None
    file: str = ""


@dataclass
class ShotState:
    """A shot in the loop.

    Attributes:
        scene: As its camera sees it at its frame.
        names: Its keys -> the shared vector's.
        vector: The shared vector under its keys.
        proxy: Renders the loop's pictures.
        anchoring: The proxy's corrections.
        guidance: Judges the pictures as the round's advice says; calibrated on the artist's picture.
        claims: What the words say that its pictures have to look like; None before the loop.
        seen: What its camera saw when the round began.
        before: The artist's picture, with which the loop began, and what its camera saw.
    """

    scene: SceneData
    names: dict[str, str]
    vector: ParameterVector
    proxy: Proxy
    anchoring: Anchoring
    guidance: Guidance | None = None
    claims: ClaimSet | None = None
    seen: GBuffer | None = None
    before: MeasuredPicture | None = None
    _last: tuple[Tensor, Correction | None, Render] | None = None
    """Where the last picture was drawn, how it was corrected, and it: rounds end and begin with the same one."""

    def draw(self, u: Tensor, free: set[str] | frozenset[str] = frozenset()) -> Render:
        """The proxy's picture of u.

        Args:
            u: (N,) in [0, 1].
            free: Keys of the shared vector in which the picture is differentiable.
        """
        if free and torch.is_grad_enabled():
            return draw(self.proxy, self.vector, u, {own for own, key in self.names.items() if key in free})
        correction = self.proxy.correction
        if not (self._last and self._last[1] is correction and torch.equal(self._last[0], u)):
            self._last = u.detach().clone(), correction, draw(self.proxy, self.vector, u.detach())
        return self._last[2]

    def seen_now(self, u: Tensor) -> GBuffer:
        """What its camera sees at u (N,)."""
        return self.proxy.gbuffer(chosen_values(self.vector, u, self.proxy.device))

    def begin(self, u: Tensor, picture: Render) -> MeasuredPicture:
        """Keeps the artist's picture, which was drawn at u (N,)."""
        self.seen = self.seen_now(u)
        self.before = MeasuredPicture(picture.display.detach(), self.seen)
        return self.before

    def look(self, u: Tensor) -> None:
        """Sees again where in the picture the claims' things are, for the camera may have moved to u (N,)."""
        if self.claims:
            self.seen = self.seen_now(u)
            self.claims = self.claims.in_view(self.seen)

    def residuals(self, picture: Render) -> list[Tensor]:
        """How far a picture is from each claim: (n,) in steps that people notice, differentiable in it."""
        return self.claims.residuals(self._measured(picture)) if self.claims else []

    def aims(self, picture: Render) -> list[tuple[Tensor, Tensor, Tensor]]:
        """What a picture has of each claim, and what is wanted, see `ClaimSet.aims`."""
        return self.claims.aims(self._measured(picture)) if self.claims else []

    def _measured(self, picture: Render) -> MeasuredPicture:
        assert self.seen is not None
        return MeasuredPicture(picture.display, replace(self.seen, transmittance=picture.transmittance))

    def take(self, plan: Plan) -> None:
        """Has what the words name be the same here as in the first shot, if this scene has another value."""
        named = {
            own
            for own, key in self.names.items()
            if plan[key].prior < 1.0
            and not self.vector.instances[own].locked
            and not _alike(self.scene.instances[own], self.vector.instances[own])
        }
        if named - self.vector.taken:
            self.vector.taken |= named
            self._last = None
            self.anchoring.expire()


def share(
    views: Sequence[ShotInput], own: Sequence[str] = ()
) -> tuple[dict[str, Instance], list[dict[str, str]]]:
    """One set of parameters for all shots: those of one name are one, and have the first shot's value.

    What is locked in one of them is locked in all, and so is what moves within a .blend.

    Args:
        own: Groups that every shot has to itself.

    Returns:
        The parameters, and for each shot its keys -> theirs.
    """
    shared: dict[str, Instance] = {}
    files: dict[str, str] = {}
    names = []
    for number, view in enumerate(views, start=1):
        mine = {}
        for key, instance in view.scene.instances.items():
            if number > 1 and instance.parameter.group in own:
                instance = replace(instance, owner=f"shot {number}")
            mine[key] = instance.key
            first = shared.setdefault(instance.key, instance)
            moves = files.setdefault(instance.key, view.file) == view.file and not _alike(first, instance)
            reason = first.locked or instance.locked or (MOVES if moves else "")
            if reason != first.locked:
                shared[instance.key] = replace(first, locked=reason)
        names.append(mine)
    return shared, names


def enter(
    views: Sequence[ShotInput],
    names: Sequence[dict[str, str]],
    vector: ParameterVector,
    proxy: Callable[[SceneData], Proxy],
) -> list[ShotState]:
    """The shots of a vector.

    Args:
        names: Of each, its keys -> the vector's, as `share` returns them.
        vector: The shared parameters.
        proxy: Makes the proxy of a scene.
    """
    shots = []
    for view, mine in zip(views, names, strict=True):
        own_vector, renderer = vector.view(mine), proxy(view.scene)
        own_vector.taken = added_values(view.scene)
        shots.append(
            ShotState(view.scene, mine, own_vector, renderer, Anchoring(renderer, own_vector, view.source))
        )
    return shots


def gathered(
    views: Sequence[ShotInput], options: Options, proxy: Callable[[SceneData], Proxy]
) -> tuple[ParameterVector, list[ShotState]]:
    """The shots of a vibe, and the vector of what they share.

    Args:
        proxy: Makes the proxy of a scene.

    Raises:
        VibeError: A group or a lock names nothing.
    """
    instances, names = share(views, ("camera", "film") if options.grade_each else ("camera",))
    vector = ParameterVector(lock(instances, options.groups, options.lock, options.camera))
    vector.taken = added_values(views[0].scene)
    return vector, enter(views, names, vector, proxy)


def added_values(scene: SceneData) -> set[str]:
    """Keys of the lights that the artist's scene lacks: writing them adds the lights."""
    added = {light.name for light in scene.lights if light.added}
    return {key for key, i in scene.instances.items() if i.parameter.group == "light" and i.owner in added}


def _alike(a: Instance, b: Instance) -> bool:
    return all(math.isclose(x, y, rel_tol=1e-4, abs_tol=1e-5) for x, y in zip(a.value, b.value, strict=True))


def lock(
    instances: Mapping[str, Instance], groups: Sequence[str], locks: Sequence[str], camera: bool
) -> dict[str, Instance]:
    """Instances with the artist's wishes in them: what may not change says why.

    Args:
        groups: Groups that may change; empty for all but the camera.
        locks: Patterns of what must stay, see `schema.matches`.
        camera: Whether the camera may move though no group names it.

    Raises:
        VibeError: For a group that does not exist and a pattern that nothing matches.
    """
    check_groups(groups)
    for pattern in locks:
        if not any(matches(key, [pattern]) for key in instances):
            owners = sorted({key.rpartition("/")[0] for key in instances if key.count("/") > 1})
            raise VibeError(
                f"The lock {pattern!r} matches nothing in this scene.",
                f"Lock a group ({', '.join(GROUPS)}), one thing ({', '.join(owners[:4])}) or a glob (*/roughness).",
            )

    def reason(key: str, group: str) -> str:
        if matches(key, list(locks)):
            return "locked by you"
        if group == "camera" and "camera" not in groups and not camera:
            return "the camera stays as you framed it"
        if groups and group not in groups and not (group == "camera" and camera):
            return f"{labels.GROUP_TITLES[group]} may not change"
        return ""

    return {
        key: replace(i, locked=i.locked or reason(key, i.parameter.group)) for key, i in instances.items()
    }


def check_groups(groups: Sequence[str]) -> None:
    """Makes sure that all groups exist.

    Raises:
        VibeError: For one that does not.
    """
    if strange := [g for g in groups if g not in GROUPS]:
        raise VibeError(f"Unknown group {strange[0]!r}.", f"Use some of: {', '.join(GROUPS)}.")
