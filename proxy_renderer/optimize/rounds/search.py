# SPDX-License-Identifier: Apache-2.0
"""What the rounds of Algorithm 1 share: scene, claims, the confiner, S_K (line 6) and the objective L."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

import torch
from torch import Tensor

from ...claims.claim import HOLDS, Claim, ClaimSet
from ...claims.wanted import claims_of
from ...goals.resolve import Goals, goals_or_why
from ...guidance.encoder import Encoder
from ...guidance.losses import claims_loss
from ...planning.advice import Advice, Advisor, OfflineAdvisor
from ...planning.types import LightPlan, Plan
from ...prompt.lexicon.user_words import default_vocabulary
from ...prompt.understood import Understood
from ...reference.advisor import advisor_with_picture
from ...reference.like import Reference
from ...render.proxy import Proxy, Render
from ...scene import SceneData
from ...schema import VibeError
from ...schema.messages import Options
from .. import context
from ..inner.descent import Descent
from ..looks import Looks
from ..progress import Clock, Observer
from ..shots import ShotInput, ShotState, gathered
from ..vector import begun
from .confiner import UNBOUND, Confined, Confiner, RoundReach, Start
from .method import Method
from .selection import Selection

_VALUES = 48  # that a round for a picture may refine, at least


class Missed(NamedTuple):
    """How far pictures are from what the words claim; the least is the best.

    Attributes:
        distance: Sum over claims of how far each is missed, see `losses.claims_loss`: one that is far off, as a subject that
            can hardly be seen, counts more than two that nearly hold.
        claims: How many do not hold.
    """

    distance: float
    claims: int


class LightAsked(Protocol):
    """The light that words ask for, set up in the scene."""

    @property
    def understood(self) -> Understood:
        """The words, read against the scene."""

    @property
    def goals(self) -> Goals | VibeError:
        """What they wish for; why there is nothing where nothing is understood."""

    @property
    def plan(self) -> LightPlan | None:
        """Of all that sheds light."""

    def claims(self, goals: Goals) -> tuple[Claim, ...]:
        """What the words claim of the image, the light's structure among it."""


class Search:
    """One vibe. Arguments as for `pipeline.run`.

    Attributes:
        several: Whether variants are wanted.
        vector: The parameters of u.
        shots: One or several, each with its proxy and guidance. Plans are made for the first.
        rounds: R, the most rounds from each start.
        method: How it searches.
        clock: Reports progress to the observer.
        number: Of the current round, over all starts.
        reference: The picture in the place of words, or beside them; None for words alone.
        claims: What words and picture claim; none before the artist's picture was seen.
        confiner: Plans, and makes boxes of plans.
        looks: Shown before the end; None where nobody wants them, and for several shots.
    """

    def __init__(
        self,
        views: Sequence[ShotInput],
        prompt: str,
        options: Options,
        encoder: Encoder,
        observer: Observer,
        advisor: Advisor | None,
        light: LightAsked | None = None,
        method: Method | None = None,
    ) -> None:
        self._light, self.method = light, method or Method()
        self._encoder, self._prompt = encoder, prompt
        self.reference = Reference.of(options, views[0].scene)
        self.claims: tuple[Claim, ...] = ()
        if self.reference:  # it speaks of all of light and grade at once
            options = replace(options, top_k=max(options.top_k, _VALUES))
        self.options, self.observer = options, observer

        def proxy(scene: SceneData) -> Proxy:
            size = context.inner_size(scene, options, encoder)
            return Proxy(scene, size, device=str(encoder.device), seed=options.seed)

        self.vector, self.shots = gathered(views, options, proxy)
        if light:
            understood, goals, plan = light.understood, light.goals, light.plan
        else:
            understood, plan = Understood(prompt, context.described(*(v.scene for v in views))), None
            goals = goals_or_why(understood)
        offline = OfflineAdvisor(goals, plan)
        has_words = bool(prompt.strip()) or isinstance(goals, Goals)
        self.offline, asked = (
            advisor_with_picture(self.reference, each, has_words, len(views), understood.scene.lights)
            for each in (offline, advisor or offline)
        )
        self.confiner = Confiner(self.vector, self.shots, understood.scene, asked, self.method.plan)
        self.several = options.variants > 1
        # Variants share what would be one vibe's time, as far as that goes.
        self.rounds = -(-options.rounds // 2) if self.several else options.rounds
        self.clock = Clock(self.rounds * (options.variants if self.several else 1), options.steps, observer)
        self._artists: list[Render] = []
        self._asked: object = None
        self.number = 0
        alone = len(self.shots) == 1
        self.looks = Looks(self.shots[0], understood.scene) if alone and observer.wants_looks else None

    def show_plan(self) -> None:
        """Shows what the words alone give, before the first anchor; the words' own plan, also where a model is asked later."""
        if self.looks is None:
            return
        try:
            u, advice = self.looks.planned(self.offline)
        except VibeError:  # if nobody else understands the words either, the first round says so
            return
        self.observer.begin(self.looks.before.display)
        self.observer.look(self.looks.values(u))
        self.observer.look(self.looks.drawn(u, self._claims_of(advice.goals)))

    def show(self, u: Tensor) -> None:
        """Shows the best look so far.

        Args:
            u: (N,) where a round has ended.
        """
        if self.looks:
            self.observer.look(self.looks.drawn(u, self.claims))

    def _claims_of(self, goals: Goals) -> tuple[Claim, ...]:
        """What words and picture claim of the first shot; of the others the same."""
        claims = self._light.claims(goals) if self._light else claims_of(goals, default_vocabulary())
        return (
            self.reference.claims(claims, self.shots[0].seen_now(self.vector.encode({})))
            if self.reference
            else claims
        )

    def renew(self, u: Tensor, number: int, **options: float) -> None:
        """Corrects the proxies of all shots at u.

        Args:
            u: (N,) where the loop is.
            number: Of the round, from 0.
            **options: As for `Anchoring.renew`.
        """
        for shot in self.shots:
            shot.anchoring.renew(u, number, **options)

    @property
    def claims_words(self) -> bool:
        """Whether the words claim anything that can be measured in the pictures."""
        return any(shot.claims and shot.claims.words for shot in self.shots)

    def missed(self, u: Tensor) -> Missed:
        """How far the pictures of u (N,) are from the words' claims; as Cycles has them, where it was just asked."""
        for shot in self.shots:
            shot.look(u)
        with torch.no_grad():
            residuals = [r for shot in self.shots for r in shot.residuals(shot.draw(u))]
            distance = float(claims_loss(residuals)) if residuals else 0.0
        return Missed(round(distance, 3), sum(float(r.norm()) > HOLDS for r in residuals))

    def confine(self, u: Tensor, earlier: Plan, start: Start | None, reach: RoundReach = UNBOUND) -> Confined:
        """Lines 2 to 5 and 7 of Algorithm 1 at u: render, parse, compose, confine, project.

        Args:
            u: (N,) the point.
            earlier: The plan of the round before; empty for the first.
            start: Where this refinement started; None for the artist's scene.
            reach: How far from u the round may go.
        """
        self.renew(u, self.number)
        advice = self.confiner.advise(u, earlier)
        self._judge_by(advice, u)
        for shot in self.shots[1:]:
            shot.take(advice.plan)
        if not earlier and not (start and start.drawn is not None):
            u = begun(self.vector, advice.plan, u)
        return self.confiner.confined(advice, u, start, reach, self.claims)

    def _judge_by(self, advice: Advice, u: Tensor) -> None:
        """Has pictures judged as this round's advice says; what the words claim is as understood at first, at u (N,)."""
        if not self._artists:  # the loop begins, at the artist's own values
            self._artists = [shot.draw(u) for shot in self.shots]
            self.observer.begin(self._artists[0].display.detach())
            self.claims = self.method.claims(self._claims_of(advice.goals))
            for shot, picture in zip(self.shots, self._artists, strict=True):
                begun = shot.begin(u, picture)
                shot.claims = ClaimSet.about(self.claims, begun)
        asked = advice.prompts, advice.unmeasured
        if asked != self._asked:
            self._asked = asked
            for shot, picture in zip(self.shots, self._artists, strict=True):
                shot.guidance = self.method.guidance(
                    self._encoder, self._prompt, advice, picture, bool(self.options.encoder)
                )

    def select(self, now: Confined, u: Tensor, shots: Sequence[ShotState] = ()) -> Selection:
        """What is minimized in a round, and over which parameters.

        Args:
            u: (N,) where the parameters are chosen.
            shots: Those that judge; all if there are none.
        """
        return self.method.select(now, self.vector, shots or self.shots, u, self.options)

    def descend(self, now: Confined, chosen: Selection) -> Descent:
        """Lines 8 to 15 of Algorithm 1, from the round's projected point.

        Args:
            chosen: S_K, and what is minimized; chosen at that point.
        """
        movable = self.vector.mark(chosen.keys) & (now.upper > now.lower)
        seed, follow = self.options.seed * 1000 + self.number, self.clock.follow(self.number)
        return self.method.descend(now, chosen, movable, self.options.steps, seed, follow)
