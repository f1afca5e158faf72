# SPDX-License-Identifier: Apache-2.0
"""The scene, words and method of one vibe, and a method for each part of a round of Algorithm 1."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import torch
from torch import Tensor

from ...claims.claim import HOLDS, Claim
from ...claims.measures.picture import is_black
from ...goals.resolve import Goals
from ...guidance.encoder import Encoder
from ...guidance.guide import Guidance, claims_loss
from ...planning.advice import Advisor
from ...reference.like import LikeAdvisor, Reference
from ...render.proxy import Proxy, Render
from ...scene import SceneData
from ...schema import VibeError
from ...schema.messages import Options
from ..least_squares import Descent
from ..looks import EarlyLook, Looks
from ..progress import Clock, Observer
from ..shots import ShotInput, ShotState, gathered, inner_size
from ..stage import StagedScenes
from ..vector import start_point
from .confiner import Confined, Confiner, RoundStart
from .key_start import with_key_turned
from .method import Method
from .selection import Selection

_STRIDE, _FURTHER_STRIDE = 0.05, 0.25
"""Share of a value's whole range: if the projection moves no value by more, no new anchor is rendered. The second is
for a further sentence, whose search begins near its result."""


class Missed(NamedTuple):
    """Distance of images from the words' claims; a smaller tuple is better."""

    distance: float  # sum of misses, see `claims_loss`: a large one counts more than two small ones
    claims: int  # number of claims that are not satisfied


class Search:
    """One vibe. Its claims and the images of the artist's values come from the first round, guidance from each advice.

    The default advisor is the offline planner, and the default method is the product's.
    """

    def __init__(
        self,
        views: Sequence[ShotInput],
        stage: StagedScenes,
        options: Options,
        encoder: Encoder,
        observer: Observer,
        advisor: Advisor | None = None,
        method: Method | None = None,
    ) -> None:
        self.method, self.observer, self._stage = method or Method(), observer, stage
        self.reference = Reference.of(options, views[0].scene)  # None for words alone
        written = stage.goals.pictured if isinstance(stage.goals, Goals) else ()
        self.pictured = bool(self.reference or written)  # whether the goals have wishes of a reference image
        if self.pictured:  # a reference image is about all of light and grade at once
            options = replace(options, top_k=max(options.top_k, 48))
        self.options = options

        def proxy(scene: SceneData) -> Proxy:
            size = inner_size(scene, options, encoder, self.pictured)
            return Proxy(scene, size, device=str(encoder.device), seed=options.seed)

        staged = zip(views, stage.scenes, strict=True)
        self.vector, self.shots = gathered([replace(v, scene=scene) for v, scene in staged], options, proxy)
        described = stage.understood.scene
        words = bool(stage.understood.prompt.strip()) or isinstance(stage.goals, Goals)
        advisors: list[Advisor] = [stage.advisor, advisor or stage.advisor]
        if self.reference:
            if len(self.shots) > 1:  # the image shows at most one of the shots
                self.reference.same = False
            seen = partial(self.shots[0].gbuffer, self.vector.encode({}))
            advisors = [LikeAdvisor(self.reference, each if words else None, seen) for each in advisors]
        self._offline, asked = advisors
        self.confiner = Confiner(self.vector, self.shots, described, asked, self.method.plan)
        self.several = options.variants > 1
        # R, the most rounds from each start. Each variant gets half, so that several take less time than as many vibes.
        self.rounds = -(-options.rounds // 2) if self.several else options.rounds
        self.clock = Clock(self.rounds * (options.variants if self.several else 1), options.steps, observer)
        self._encoder = encoder
        self.claims: tuple[Claim, ...] = ()  # of words and reference image; none before the first round
        self._artist: list[Render] = []  # each shot's image of the artist's values, on which guidance is calibrated
        self._asked: object = None  # the captions that the guidance was made for
        self._guidance: list[Guidance] = []  # one for each shot
        alone = len(self.shots) == 1 and observer.wants_looks
        self.looks = Looks(self.shots[0], described) if alone else None  # looks before the end

    def show_plan(self) -> None:
        """Shows the observer the look of the words alone, before the first anchor, by the offline planner's plan."""
        if self.looks is None:
            return
        try:
            u, advice = self.looks.planned(self._offline)
        except VibeError:  # the first round raises the error again, unless its advisor understands the words
            return
        self.observer.begin(self.looks.before, True)  # whether Cycles' image is black is not known yet
        self.observer.look(EarlyLook(self.shots[0].vector.changes(u), None, {}))
        self.observer.look(self.looks.drawn(u, self._stage.claims(advice.goals)))

    def show(self, shots: Sequence[ShotState], u: Tensor) -> None:
        """Shows the observer the best look so far, at u (N,)."""
        if self.looks:
            self.observer.look(self.looks.drawn(u, self.claims, shots[0]))

    def confine(self, here: RoundStart) -> Confined:
        """Lines 2 to 5 and 7 of Algorithm 1: render, parse, compose, confine, project."""
        u = artist = here.u
        shots = [shot.anchored(u, here.number) for shot in here.shots]
        advice = self.confiner.advise(shots, u, here.earlier)
        if begins := not self._artist:
            self.claims = self.method.claims(self._stage.claims(advice.goals))
            self._artist = [shot.draw(u) for shot in shots]
        if self._asked != (asked := (advice.prompts, advice.unmeasured)):
            self._asked, every = asked, bool(self.options.encoder)
            self._guidance = [self.method.guidance(self._encoder, advice, image, every) for image in self._artist]
        rows = zip(shots, self._artist, self._guidance, strict=True)
        first, *others = (replace(shot.judged(self.claims, image, u), guidance=g) for shot, image, g in rows)
        shots = [first, *(shot.planned(advice.plan) for shot in others)]
        if not here.earlier and not here.near:
            u = start_point(self.vector, advice.plan, u)
        now = self.confiner.confined(advice, u, here, shots, self.claims)
        if begins:
            image = shots[0].draw(artist).display
            with torch.no_grad():
                self.observer.begin(image, not (is_black(image) and is_black(shots[0].draw(now.u).display)))
        return now

    def placed(self, now: Confined) -> Confined:
        """The round at the point where its steps begin, see `with_key_turned`, where its proxies are corrected."""
        u, here = now.u, now.here
        if not here.earlier and self.reference and self.reference.same:
            u = with_key_turned(self.shots[0].scene, self.vector, u, now.lower, now.upper, self.reference.display)
        stride = _FURTHER_STRIDE if self.options.goes_on else _STRIDE
        shots = [shot.anchored(u, here.number, stride).viewed(u) for shot in now.shots]
        return replace(now, u=u, shots=shots)

    def select(self, now: Confined, u: Tensor, shots: Sequence[ShotState] = ()) -> Selection:
        """S_K, the parameters to optimize (line 6), chosen at u (N,), and the objective over `shots`, all if empty."""
        return self.method.select(now, self.vector, shots or now.shots, u, self.options)

    def descend(self, now: Confined, chosen: Selection) -> Descent:
        """Lines 8 to 15 of Algorithm 1, from the round's point, where S_K was chosen."""
        seed, follow = self.options.seed * 1000 + now.here.number, self.clock.follow(now.here.number)
        return self.method.descend(now, chosen, self.options.steps, seed, follow)

    def seen(self, shots: Sequence[ShotState], u: Tensor, number: int) -> tuple[list[ShotState], Missed]:
        """The shots, corrected by Cycles images at u (N,) in round `number`, and how far the images miss the claims."""
        shots = [shot.anchored(u, number).viewed(u) for shot in shots]
        residuals = [r for shot in shots for r in shot.missed(u)]
        distance = float(claims_loss(residuals)) if residuals else 0.0
        return shots, Missed(round(distance, 3), sum(float(r.norm()) > HOLDS for r in residuals))
