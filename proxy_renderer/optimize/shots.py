# SPDX-License-Identifier: Apache-2.0
"""Shots that share a look: several cameras, frames or scenes with one vector of values for all of them."""

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
from .known_picture import KnownPicture, alike
from .scene_facts import described_now
from .vector import ParameterVector, exposed_through_air

SAMPLES = 16  # samples per pixel of an anchor
LONGEST = 30.0  # seconds that an anchor may take; after a slower one no more are requested

AnchorRequest = Callable[[messages.Anchor], messages.Anchored | None]  # to Blender; None to end the loop


class BlenderPictures:
    """A source of Cycles images of one shot, which Blender renders; none after two failures in a row or a slow one."""

    def __init__(self, scene: SceneData, ask: AnchorRequest, seed: int, shot: int = 0) -> None:
        self._scene, self._ask, self._seed, self._shot = scene, ask, seed, shot
        self._number = self._failures = 0
        self._over = False
        self.seconds: list[float] = []  # Blender's time for each image
        self.waited = 0.0  # seconds that requests waited because Blender was busy, as with the artist's image
        self.notes: list[str] = []  # failures, in words for the artist

    def __call__(self, values: dict[str, list[float]], size: tuple[int, int]) -> CyclesPicture | None:
        """A Cycles image of the values with `size` (width, height); None if Blender gives none."""
        if self._over:
            return None
        self._number += 1
        request = messages.Anchor(self._number, values, max(size), SAMPLES, self._seed, self._shot)
        asked = time.monotonic()
        answer = self._ask(request)
        if answer is None:
            return None
        self.waited += max(time.monotonic() - asked - answer.seconds, 0.0)
        path = Path(self._scene.folder) / answer.picture
        try:
            if answer.error:
                raise VibeError(answer.error)
            picture = CyclesPicture.load(path, answer.groups)
            if picture.size != size:
                raise VibeError(f"it has {picture.size} pixels instead of {size}")
        except VibeError as error:
            self._failures += 1
            self._over = self._failures == 2  # in a row
            note = f"Without a Cycles picture for a while: {error.message.rstrip('.')}."
            self.notes += [note] if note not in self.notes else []
            return None
        path.unlink(missing_ok=True)
        self._failures = 0
        self.seconds.append(answer.seconds)
        if answer.seconds > LONGEST:
            self._over = True
            self.notes.append(f"A small Cycles picture takes {answer.seconds:.0f} s here, too long for more of them.")
        return picture


PictureSource = Callable[[dict[str, list[float]], tuple[int, int]], CyclesPicture | None]


@dataclass(frozen=True)
class AnchorState:
    """The correction of a proxy by a Cycles image, the anchor."""

    correction: Correction | None = None  # None for the uncorrected proxy
    u: Tensor | None = None  # (N,) the point where the correction is exact; None without an anchor that is still valid
    earlier: Correction | None = None  # the correction before this one
    picture: CyclesPicture | None = None  # the anchor

    def distance(self, u: Tensor) -> float:
        """Largest difference of a component of u (N,) from the anchor's, in [0, 1]; infinite without an anchor."""
        return float((u - self.u).abs().max()) if self.u is not None else float("inf")


LOCKED = "locked by you"
MOVES = "it changes from shot to shot in your scene"  # why a value is locked that differs within one .blend

_HERE = 0.01  # distance from an anchor, see `AnchorState.distance`, within which no new anchor is needed
_NEAR = 0.25  # distance up to which an old correction is better than none

_LARGEST, _USUAL = 256, 144
"""Longer side in pixels of the images inside the loop: the largest, and the usual one. 192 takes 1.7 times as long."""
_OF_A_PICTURE = 128  # the usual one if there is a reference image: no fine details are measured


@dataclass(frozen=True)
class ShotInput:
    """A shot, which is one of several cameras, frames or scenes, before the loop."""

    scene: SceneData  # as its camera sees it at its frame
    source: PictureSource | None = None  # of Cycles images; None if there are none
    file: str = ""  # name of its .blend: values that differ within one .blend are animated
    known: KnownPicture | None = None  # the last Cycles image of the run before, if there is one


@dataclass
class ShotState:
    """A shot in the loop. Methods return a new state for a new anchor, view or plan; a state itself only changes its caches."""

    scene: SceneData  # as its camera sees it at its frame
    names: dict[str, str]  # key of the shot -> key in the shared vector
    vector: ParameterVector  # a view of the shared vector with the shot's keys
    proxy: Proxy  # one for all states of a shot; to draw, use `corrected`
    source: PictureSource | None = None  # of Cycles images
    anchor: AnchorState = field(default_factory=AnchorState)  # the proxy's correction
    records: list[dict[str, Any]] = field(default_factory=list)  # one per anchor, shared by all states, see `anchored`
    guidance: Guidance | None = None  # judges images by the round's advice; calibrated on the artist's image
    before: MeasuredPicture | None = None  # the proxy's image of the artist's values; None before the loop
    claims: ClaimSet | None = None  # about the shot's images; None before the loop
    seen: GBuffer | None = None  # the camera's view in which the claims are measured
    _seen_at: Tensor | None = None  # (N,) the point u at which `seen` was made
    _last: tuple[Tensor, Render] | None = None  # cache: the point u of the last image, and the image

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
        """An advisor's advice from the shot's scene and image at u (N,); raises VibeError if the advisor has none."""
        image = self.draw(u)
        now = described_now(described, self.proxy, self.vector.values(u), image)
        advice = advisor.advise(image.display, self.vector.instances, now)
        # `self.draw` would forget the image of u
        proxy, vector = self.corrected, self.vector
        plan = exposed_through_air(advice.plan, vector, lambda point: draw(proxy, vector, point).linear)
        return replace(advice, plan=plan)

    def anchored(self, u: Tensor, number: int, slack: float = _HERE) -> ShotState:
        """The shot with its proxy corrected at u (N,) by a new Cycles image, in round `number`, from 0.

        It stays the same without a source, or if its anchor lies within `slack` of u, or if only light and film differ
        from its anchor: a sum of the anchor's light layers is then exact at u, too.
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

    def known_picture(self) -> KnownPicture | None:
        """The Cycles image that corrects the proxy, for the run of a further sentence; None without an anchor."""
        if self.anchor.picture is None or self.anchor.u is None:
            return None
        return KnownPicture(self.scene, self.vector.values(self.anchor.u), self.anchor.picture)

    def _with(self, anchor: AnchorState, vector: ParameterVector | None = None) -> ShotState:
        return replace(self, anchor=anchor, vector=vector or self.vector, _last=None, _seen_at=None)

    def gbuffer(self, u: Tensor) -> GBuffer:
        """The G-buffer at u (N,): the surfaces that the camera sees."""
        return self.proxy.gbuffer(chosen_values(self.vector, u, self.proxy.device))

    def viewed(self, u: Tensor) -> ShotState:
        """The shot with the image regions of its claims found again at u (N,), where the camera may have moved."""
        if self.claims is None or (self._seen_at is not None and torch.equal(self._seen_at, u)):
            return self
        seen = self.gbuffer(u)
        return replace(self, seen=seen, claims=self.claims.in_view(seen), _seen_at=u.detach().clone())

    def judged(self, claims: tuple[Claim, ...], image: Render, u: Tensor) -> ShotState:
        """The shot with `claims`, measured on `image`, of the artist's values u (N,); the same if it has claims."""
        if self.claims is not None:
            return self
        before = MeasuredPicture(image.display.detach(), self.gbuffer(u))
        return replace(self, before=before, claims=ClaimSet.about(claims, before), seen=before.seen)

    @torch.no_grad()
    def missed(self, u: Tensor) -> list[Tensor]:
        """Distance of the shot's image at u (N,) from each measurable claim: (n,) each, in noticeable steps."""
        viewed = self.viewed(u)
        return viewed.residuals(viewed.draw(u))

    def residuals(self, picture: Render) -> list[Tensor]:
        """Distance of an image from each measurable claim: (n,) each, in noticeable steps, differentiable."""
        return self.claims.residuals(self._measured(picture)) if self.claims else []

    def aims(self, picture: Render) -> list[tuple[Claim, Tensor, Tensor, Tensor]]:
        """Measurable claims, each with its value in an image and the ends of its aim, see `ClaimSet.aims`."""
        return self.claims.aims(self._measured(picture)) if self.claims else []

    def _measured(self, picture: Render) -> MeasuredPicture:
        assert self.seen is not None
        return MeasuredPicture(picture.display, replace(self.seen, transmittance=picture.transmittance))

    def planned(self, plan: Plan) -> ShotState:
        """The shot, where parameters that the plan lets move have the vector's values instead of its own scene's."""
        theirs, shared = self.scene.instances, self.vector.instances
        free = (own for own, key in self.names.items() if plan[key].prior < 1.0 and not shared[own].locked)
        named = {own for own in free if not alike(theirs[own].value, shared[own].value)}
        if named <= self.vector.taken:
            return self
        # The last anchor shows other values than u now stands for, so a new one is needed.
        return self._with(replace(self.anchor, u=None), self.vector.taking(named))


def draw(proxy: Proxy, vector: ParameterVector, u: Tensor, free: set[str] | frozenset[str] = frozenset()) -> Render:
    """The proxy's image of u (N,), I = R(θ), equation 1; only values that differ from the artist's are set, see `chosen_values`."""
    return proxy.render(chosen_values(vector, u, proxy.device, free))


def chosen_values(
    vector: ParameterVector, u: Tensor, device: torch.device, free: set[str] | frozenset[str] = frozenset()
) -> dict[str, Tensor]:
    """Key -> (C,) float32 value at u (N,), schema units: of free keys, with gradients, and of changed or taken keys."""
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
    """The vector of values that the shots of a vibe share, and the shots; `proxy` makes the proxy of a shot's scene.

    Raises VibeError if a group or a lock of the options names nothing.
    """
    instances, names = shared_parameters(views, ("camera", "film") if options.grade_each else ("camera",))
    vector = ParameterVector(lock(instances, options.groups, options.lock, options.camera))
    vector = vector.taking(added_values(views[0].scene), views[0].scene.links)
    shots = []
    for view, mine in zip(views, names, strict=True):
        own = vector.view(mine).taking(added_values(view.scene), view.scene.links)
        shot = ShotState(view.scene, mine, own, proxy(view.scene), view.source)
        # The Cycles image of an earlier vibe corrects the proxy, if it shows the scene as it is now.
        known = view.known if view.known and view.known.picture.size == shot.proxy.size else None
        if known and (values := known.values_in(view.scene)) is not None:
            u = own.encode(values)
            correction = shot.proxy.anchor(chosen_values(own, u, shot.proxy.device), known.picture)
            shot.anchor = AnchorState(correction, u, picture=known.picture)
        shots.append(shot)
    return vector, shots


def shared_parameters(
    views: Sequence[ShotInput], own: Sequence[str] = ()
) -> tuple[dict[str, Instance], list[dict[str, str]]]:
    """Shared parameters by key, with the first shot's values; and for each shot: its own key -> shared key.

    A value that is locked in one shot is locked in all, and so is a value that differs between shots of one .blend.
    Parameters of the groups in `own` are not shared: each shot has its own.
    """
    shared: dict[str, Instance] = {}
    files: dict[str, str] = {}
    names: list[dict[str, str]] = [{} for _ in views]
    for number, (view, mine) in enumerate(zip(views, names, strict=True), start=1):
        for key, instance in view.scene.instances.items():
            if number > 1 and instance.parameter.group in own:
                instance = replace(instance, owner=f"shot {number}")
            mine[key] = instance.key
            first = shared.setdefault(instance.key, instance)
            moves = files.setdefault(instance.key, view.file) == view.file and not alike(first.value, instance.value)
            reason = first.locked or instance.locked or (MOVES if moves else "")
            shared[instance.key] = replace(first, locked=reason)
    return shared, names


def added_values(scene: SceneData) -> set[str]:
    """Keys of the parameters of lights that the artist's scene lacks: writing these values adds the lights."""
    added = {light.name for light in scene.lights if light.added}
    return {key for key, i in scene.instances.items() if i.parameter.group == "light" and i.owner in added}


def lock(
    instances: Mapping[str, Instance], groups: Sequence[str], locks: Sequence[str], camera: bool
) -> dict[str, Instance]:
    """Key -> instance, whose `locked` has the reason if it may not change; else "".

    Only the groups in `groups` may change, if there are any; the camera only if `groups` or `camera` allow it. Raises
    VibeError if a group or a lock names nothing.
    """
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

    return {key: replace(i, locked=i.locked or reason(key, i.parameter.group)) for key, i in instances.items()}


def picture_size(resolution: tuple[int, int], longest: int) -> tuple[int, int]:
    """(width, height) in pixels of the artist's image, scaled so that the longer side has `longest` pixels."""
    width, height = (max(round(n * (longest / max(resolution))), 1) for n in resolution)
    return width, height


def inner_size(scene: SceneData, options: Options, encoder: Encoder, pictured: bool) -> tuple[int, int]:
    """(width, height) of the images inside the loop, at most the options' `size`; the prediction has the full size.

    If the options name an encoder, the longer side is at least one and a half times the encoder's input, because crops are at least
    three quarters of the image. With a reference image (`pictured`) less is enough.
    """
    enough = _OF_A_PICTURE if pictured else max(_USUAL, encoder.size * 3 // 2 if options.encoder else 0)
    return picture_size(scene.resolution, min(options.size, _LARGEST, enough))
