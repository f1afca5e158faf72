# SPDX-License-Identifier: Apache-2.0
"""Shots that share a look: several cameras, frames or scenes, and one vector of values for all of them."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from ..claims.claim import Claim, ClaimSet
from ..claims.measures.picture import MeasuredPicture
from ..color.tensors import mean_difference
from ..guidance.encoder import Encoder
from ..guidance.guide import Guidance
from ..planning.advice import Advice, Advisor
from ..planning.types import Plan
from ..render.cycles import Correction, CyclesPicture
from ..render.proxy import Proxy, Render
from ..render.surface.view_cache import GBuffer
from ..scene import SceneData
from ..schema import GROUPS, Instance, VibeError, labels, matches, material_copies, messages
from ..schema.messages import Options
from ..words.types import SceneDescription
from .air_exposure import exposed_through_air
from .known_picture import KnownPicture, alike
from .scene_facts import described_now
from .vector import ParameterVector

SAMPLES = 16
LONGEST = 30.0  # seconds that a picture may take; after a slower one no more are asked for
_FAILURES = 2  # in a row, after which no more pictures are asked for

AnchorRequest = Callable[[messages.Anchor], messages.Anchored | None]  # to Blender; None to end the loop


class BlenderPictures:
    """A source of Cycles' pictures of one of a vibe's shots. Failures are noted, and the loop goes on without."""

    def __init__(self, scene: SceneData, ask: AnchorRequest, seed: int, shot: int = 0) -> None:
        self._scene, self._ask, self._seed, self._shot = scene, ask, seed, shot
        self._number = self._failures = 0
        self._over = False
        self.seconds: list[float] = []  # Blender's time for each picture
        # seconds that it was busy with something else, as the artist's own image, when it was asked
        self.waited = 0.0
        self.notes: list[str] = []  # failures, in words for the artist

    def __call__(self, values: dict[str, list[float]], size: tuple[int, int]) -> CyclesPicture | None:
        """A picture of values, of a width and height; None where there is none to be had."""
        if self._over:
            return None
        self._number += 1
        request = messages.Anchor(self._number, values, max(size), SAMPLES, self._seed, self._shot)
        asked = time.monotonic()
        answer = self._ask(request)
        if answer is None:
            return None
        self.waited += max(time.monotonic() - asked - answer.seconds, 0.0)
        try:
            picture = self._load(answer, size)
        except VibeError as error:
            self._failures += 1
            self._over = self._failures >= _FAILURES
            self._note(f"Without a Cycles picture for a while: {error.message.rstrip('.')}")
            return None
        self._failures = 0
        self.seconds.append(answer.seconds)
        if answer.seconds > LONGEST:
            self._over = True
            self._note(f"A small Cycles picture takes {answer.seconds:.0f} s here, too long for more of them")
        return picture

    def _load(self, answer: messages.Anchored, size: tuple[int, int]) -> CyclesPicture:
        """The picture of an answer; raises VibeError if it has none that can be used."""
        if answer.error:
            raise VibeError(answer.error, "")
        path = Path(self._scene.folder) / answer.picture
        picture = CyclesPicture.load(path, answer.groups)
        if picture.size != size:
            raise VibeError(f"it has {picture.size} pixels instead of {size}", "")
        path.unlink(missing_ok=True)
        return picture

    def _note(self, text: str) -> None:
        if f"{text}." not in self.notes:
            self.notes.append(f"{text}.")


PictureSource = Callable[[dict[str, list[float]], tuple[int, int]], CyclesPicture | None]


@dataclass(frozen=True)
class AnchorState:
    """A proxy's correction by a picture of Cycles."""

    correction: Correction | None = None  # None for the plain proxy
    # (N,) the values of the picture, where the correction is exact; None where there is no picture of the current
    # ones
    u: Tensor | None = None
    earlier: Correction | None = None  # the one before: what was a prediction worth without the last picture?
    picture: CyclesPicture | None = None

    def distance(self, u: Tensor) -> float:
        """Distance of u (N,) from the picture, in its worst component's whole range; infinite without one."""
        return float((u - self.u).abs().max()) if self.u is not None else float("inf")


LOCKED = "locked by you"
MOVES = "it changes from shot to shot in your scene"  # why a value is locked that differs in one .blend

_HERE = 0.01  # of a component's whole range: so near to an anchor, its correction is as good as a new one
_NEAR = 0.25  # of a component's whole range: so far an old correction is better than none

_LARGEST, _USUAL = 256, 144
"""Greatest longer side of the images inside the loop, in pixels, and the usual one: 192 cost 1.7 times as much for the same looks."""
_OF_A_PICTURE = 128  # the greatest where a reference image is the goal: nothing so fine is read off it


@dataclass(frozen=True)
class ShotInput:
    """A shot before the loop."""

    scene: SceneData  # as its camera sees it at its frame
    source: PictureSource | None = None  # of Cycles' pictures of it; None for none
    file: str = ""  # names its .blend: what differs within one .blend is animated
    known: KnownPicture | None = None  # the one that the vibe before has ended with


@dataclass
class ShotState:
    """A shot in the loop. Its methods change nothing but what is cached: a new anchor, view or plan gives another state."""

    scene: SceneData  # as its camera sees it at its frame
    names: dict[str, str]  # its keys -> the shared vector's
    vector: ParameterVector  # the shared vector under its keys
    proxy: Proxy  # renders the loop's images; all states of a shot have the same one. Use `corrected`
    source: PictureSource | None = None  # of Cycles' pictures
    anchor: AnchorState = field(default_factory=AnchorState)  # the proxy's correction
    # one per picture of Cycles, for all states: the number of the round, and the mean CIEDE2000 between what the
    # proxy had predicted and what it says with the picture
    records: list[dict[str, Any]] = field(default_factory=list)
    guidance: Guidance | None = None  # judges images by the round's advice; calibrated on the artist's image
    before: MeasuredPicture | None = None  # the artist's image, and what its camera saw; None before the loop
    claims: ClaimSet | None = None  # what the words say that its images look like, likewise
    # Of the place where the claims are measured, by values and anchor: the point (N,), and what the camera sees there
    seen: GBuffer | None = None
    _seen_at: Tensor | None = None
    _last: tuple[Tensor, Render] | None = None  # where the last image was drawn, and it

    @property
    def corrected(self) -> Proxy:
        """The proxy, corrected by this state's anchor."""
        self.proxy.correction = self.anchor.correction
        return self.proxy

    def draw(self, u: Tensor, free: set[str] | frozenset[str] = frozenset()) -> Render:
        """The proxy's image of u (N,), differentiable in the free keys of the shared vector."""
        if free and torch.is_grad_enabled():
            own = {own for own, key in self.names.items() if key in free}
            return draw(self.corrected, self.vector, u, own)
        if not (self._last and torch.equal(self._last[0], u)):
            self._last = u.detach().clone(), draw(self.corrected, self.vector, u.detach())
        return self._last[1]

    def advised(self, advisor: Advisor, u: Tensor, described: SceneDescription) -> Advice:
        """An advisor's advice on this shot at u (N,), by its scene and its image; raises VibeError where there is none."""
        image = self.draw(u)
        now = described_now(described, self.proxy, self.vector.values(u), image)
        advice = advisor.advise(image.display, self.vector.instances, now)
        plan = exposed_through_air(advice.plan, self.vector, lambda point: self.draw(point).linear)
        return replace(advice, plan=plan)

    def anchored(self, u: Tensor, number: int, slack: float = _HERE) -> ShotState:
        """The shot with its proxy corrected at u (N,) by a picture of Cycles, if there is one and none within the slack.

        A picture from which only light and film differ is exact at u, too.
        """
        distance = self.anchor.distance(u)
        if self.source is None or distance <= slack:
            return self
        values = chosen_values(self.vector, u, self.proxy.device)
        if self.corrected.layered(values) is not None:
            return self
        picture = self.source({k: list(v) for k, v in self.vector.changes(u).items()}, self.proxy.size)
        if picture is None:
            return self if distance <= _NEAR else self._with(AnchorState())
        with torch.no_grad():
            predicted = self.draw(u).display
            correction = self.proxy.anchor(values, picture)
            shot = self._with(AnchorState(correction, u.clone(), self.anchor.correction, picture))
            difference = float(mean_difference(predicted, shot.draw(u).display))
        self.records.append({"round": number + 1, "delta_e": round(difference, 3)})
        return shot

    def reminded(self, known: KnownPicture) -> ShotState:
        """The shot with its proxy corrected by a picture of an earlier vibe, where that shows the scene as it is now."""
        values = known.values_in(self.scene) if known.picture.size == self.proxy.size else None
        if values is None:
            return self
        u = self.vector.encode(values)
        correction = self.proxy.anchor(chosen_values(self.vector, u, self.proxy.device), known.picture)
        return self._with(AnchorState(correction, u, picture=known.picture))

    def known_picture(self) -> KnownPicture | None:
        """The picture that corrects the proxy, for a vibe that follows; None where there is none."""
        if self.anchor.picture is None or self.anchor.u is None:
            return None
        return KnownPicture(self.scene, self.vector.values(self.anchor.u), self.anchor.picture)

    def _with(self, anchor: AnchorState, vector: ParameterVector | None = None) -> ShotState:
        """The shot with another anchor or vector, for which nothing is drawn yet."""
        return replace(self, anchor=anchor, vector=vector or self.vector, _last=None, _seen_at=None)

    def gbuffer(self, u: Tensor) -> GBuffer:
        """The camera's view at u (N,)."""
        return self.proxy.gbuffer(chosen_values(self.vector, u, self.proxy.device))

    def viewed(self, u: Tensor) -> ShotState:
        """The shot with its claims measured where their objects are in the image of u (N,): the camera may have moved."""
        if self.claims is None or (self._seen_at is not None and torch.equal(self._seen_at, u)):
            return self
        seen = self.gbuffer(u)
        return replace(self, seen=seen, claims=self.claims.in_view(seen), _seen_at=u.detach().clone())

    def judged(self, claims: tuple[Claim, ...], image: Render, u: Tensor) -> ShotState:
        """The shot with claims about its images, of which this is the artist's, at u (N,); the same if it has claims."""
        if self.claims is not None:
            return self
        before = MeasuredPicture(image.display.detach(), self.gbuffer(u))
        return replace(self, before=before, claims=ClaimSet.about(claims, before), seen=before.seen)

    @torch.no_grad()
    def missed(self, u: Tensor) -> list[Tensor]:
        """Distance of its image at u (N,) from each claim: (n,) in noticeable steps, measured where its objects are there."""
        viewed = self.viewed(u)
        return viewed.residuals(viewed.draw(u))

    def residuals(self, picture: Render) -> list[Tensor]:
        """Distance of an image from each claim: (n,) in noticeable steps, differentiable in it."""
        return self.claims.residuals(self._measured(picture)) if self.claims else []

    def aims(self, picture: Render) -> list[tuple[Claim, Tensor, Tensor, Tensor]]:
        """Claims with an image's value for each, and the interval that is sought, see `ClaimSet.aims`."""
        return self.claims.aims(self._measured(picture)) if self.claims else []

    def _measured(self, picture: Render) -> MeasuredPicture:
        assert self.seen is not None
        return MeasuredPicture(picture.display, replace(self.seen, transmittance=picture.transmittance))

    def planned(self, plan: Plan) -> ShotState:
        """The shot with what the words name being the same as in the first shot, if its own scene has another value."""
        named = {
            own
            for own, key in self.names.items()
            if plan[key].prior < 1.0
            and not self.vector.instances[own].locked
            and not alike(self.scene.instances[own].value, self.vector.instances[own].value)
        }
        if named <= self.vector.taken:
            return self
        # The last picture shows other values than u now says: another one is due.
        return self._with(replace(self.anchor, u=None), self.vector.taking(named))


def draw(
    proxy: Proxy, vector: ParameterVector, u: Tensor, free: set[str] | frozenset[str] = frozenset()
) -> Render:
    """The proxy's image of u (N,), I = R(θ), equation 1; values that are the artist's own are left to the scene as they are."""
    return proxy.render(chosen_values(vector, u, proxy.device, free))


def chosen_values(
    vector: ParameterVector, u: Tensor, device: torch.device, free: set[str] | frozenset[str] = frozenset()
) -> dict[str, Tensor]:
    """Key -> (components,) float32 in schema units, of u (N,): values that are free, with gradients, or no longer the artist's."""
    moved = (u.detach() - vector.encode({})).abs() > 1e-9
    values = {}
    for key, value in vector.decode(u).items():
        if key in free:
            values[key] = value.to(device)
        elif key in vector.taken or moved[vector.slices[key]].any():
            values[key] = value.detach().to(device)
    return values


def gathered(
    views: Sequence[ShotInput], options: Options, proxy: Callable[[SceneData], Proxy]
) -> tuple[ParameterVector, list[ShotState]]:
    """The vector of what the shots of a vibe share, and the shots; raises VibeError if a group or a lock names nothing."""
    instances, names = shared_parameters(views, ("camera", "film") if options.grade_each else ("camera",))
    vector = ParameterVector(lock(instances, options.groups, options.lock, options.camera))
    vector = vector.taking(added_values(views[0].scene))
    vector.links = tuple(views[0].scene.links)
    shots = []
    for view, mine in zip(views, names, strict=True):
        own = vector.view(mine).taking(added_values(view.scene))
        own.links = tuple(view.scene.links)
        shot = ShotState(view.scene, mine, own, proxy(view.scene), view.source)
        shots.append(shot.reminded(view.known) if view.known else shot)
    return vector, shots


def shared_parameters(
    views: Sequence[ShotInput], own: Sequence[str] = ()
) -> tuple[dict[str, Instance], list[dict[str, str]]]:
    """One set of parameters for all shots, by name, and for each shot its keys -> theirs; values are the first shot's.

    A value that is locked in one of them is locked in all, and so is one that moves within a .blend. Every shot has the groups
    in `own` to itself.
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
            moves = files.setdefault(instance.key, view.file) == view.file and not alike(
                first.value, instance.value
            )
            reason = first.locked or instance.locked or (MOVES if moves else "")
            if reason != first.locked:
                shared[instance.key] = replace(first, locked=reason)
        names.append(mine)
    return shared, names


def added_values(scene: SceneData) -> set[str]:
    """Keys of the lights that the artist's scene lacks: writing them adds the lights."""
    added = {light.name for light in scene.lights if light.added}
    return {key for key, i in scene.instances.items() if i.parameter.group == "light" and i.owner in added}


def lock(
    instances: Mapping[str, Instance], groups: Sequence[str], locks: Sequence[str], camera: bool
) -> dict[str, Instance]:
    """Instances with the artist's locks, and why; without groups the camera is locked. Raises VibeError for what names nothing."""
    if strange := [g for g in groups if g not in GROUPS]:
        raise VibeError(f"Unknown group {strange[0]!r}.", f"Use some of: {', '.join(GROUPS)}.")
    for pattern in locks:
        if not any(matches(key, [pattern]) for key in instances):
            owners = sorted({key.rpartition("/")[0] for key in instances if key.count("/") > 1})
            raise VibeError(
                f"The lock {pattern!r} matches nothing in this scene.",
                f"Lock a group ({', '.join(GROUPS)}), one thing ({', '.join(owners[:4])}) or a glob (*/roughness).",
            )

    def reason(key: str, group: str) -> str:
        if any(matches(each, list(locks)) for each in (key, material_copies.copied_key(key))):
            return LOCKED
        if group == "camera" and "camera" not in groups and not camera:
            return "the camera stays as you framed it"
        if groups and group not in groups and not (group == "camera" and camera):
            return f"{labels.GROUP_TITLES[group]} may not change"
        return ""

    return {
        key: replace(i, locked=i.locked or reason(key, i.parameter.group)) for key, i in instances.items()
    }


def picture_size(resolution: tuple[int, int], longest: int) -> tuple[int, int]:
    """Width and height of the artist's image, pixels, scaled so that the longer side has `longest`."""
    factor = longest / max(resolution)
    width, height = (max(round(n * factor), 1) for n in resolution)
    return width, height


def inner_size(scene: SceneData, options: Options, encoder: Encoder, pictured: bool) -> tuple[int, int]:
    """Width and height of the images inside the loop, at most the options' `size`; the prediction has the full size.

    For an encoder that somebody names it is one and a half times what that looks at, as crops are at least three quarters
    of the image. A reference image, where goals are `pictured`, needs less.
    """
    enough = _OF_A_PICTURE if pictured else max(_USUAL, encoder.size * 3 // 2 if options.encoder else 0)
    return picture_size(scene.resolution, min(options.size, _LARGEST, enough))
