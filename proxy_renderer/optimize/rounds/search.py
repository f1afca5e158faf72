# SPDX-License-Identifier: Apache-2.0
"""What the rounds of Algorithm 1 share: the confiner (lines 2 to 5 and 7), S_K (line 6) and the objective L."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import torch
from torch import Tensor

from ...claims.claim import HOLDS, Claim, ClaimSet
from ...claims.wanted import claims_of
from ...guidance.encoder import Encoder
from ...guidance.losses import claims_loss
from ...planning.advice import Advice, Advisor, OfflineAdvisor
from ...planning.types import Plan, PlanEntry
from ...prompt.lexicon.user_words import default_vocabulary
from ...prompt.types import Parsed
from ...reference.advisor import beside
from ...reference.like import Reference
from ...render.proxy import Proxy, Render
from ...scene import SceneData
from ...schema import Values, VibeError
from ...schema.messages import Options
from .. import context, headroom
from ..baseline import plan_everything, step_settings
from ..inner.adam import descend
from ..inner.descent import Descent
from ..inner.least_squares import solve
from ..looks import Looks
from ..plan import carry, feasible_ranges
from ..progress import Clock, Observer
from ..shots import ShotInput, ShotState, gathered
from ..vector import around, opened, project
from . import starts
from .judges import make_guidance, weights_of
from .selection import Selection, select

_VALUES = 48  # that a round for a picture may refine, at least


@dataclass
class Start:
    """Where a refinement starts.

    Attributes:
        u: (N,) the point.
        drawn: (N,) bool, the components that were drawn at random; they stay near u. None for the artist's scene.
    """

    u: Tensor
    drawn: Tensor | None = None


class Missed(NamedTuple):
    """How far pictures are from what the words claim; the least is the best.

    Attributes:
        distance: Sum over claims of how far each is missed, see `losses.claims_loss`: one that is far off, as a subject that
            can hardly be seen, counts more than two that nearly hold.
        claims: How many do not hold.
    """

    distance: float
    claims: int


@dataclass
class Confined:
    """A round, confined: lines 3 to 5 and 7 of Algorithm 1.

    Attributes:
        advice: Objects and attributes O, prompts p and negative prompts p⁻.
        plan: Range and priority π_i of every parameter, by key.
        ranges: Key -> (l_i, u_i) in schema units, azimuths turned to where the values are.
        lower: (N,) lower corner of the feasible box in u.
        upper: (N,) upper corner.
        u: (N,) the point, projected into the box.
        opening: By how much ranges are wider than the plan's, since claims are missed; 0 in the first round.
    """

    advice: Advice
    plan: Plan
    ranges: dict[str, tuple[Values, Values]]
    lower: Tensor
    upper: Tensor
    u: Tensor
    opening: float = 0.0


class Search:
    """One vibe. Arguments as for `pipeline.run`.

    Attributes:
        several: Whether variants are wanted.
        vector: The parameters of u.
        shots: One or several, each with its proxy and guidance. Plans are made for the first.
        rounds: R, the most rounds from each start.
        weights: Of the terms of the loss.
        clock: Reports progress to the observer.
        number: Of the current round, over all starts.
        reference: The picture in the place of words, or beside them; None for words alone.
        claims: What words and picture claim; none before the artist's picture was seen.
        looks: Shown before the end; None where nobody wants them, and for several shots.
    """

    def __init__(
        self,
        views: Sequence[ShotInput],
        prompt: str,
        options: Options,
        encoder: Encoder,
        heads: Encoder | None,
        observer: Observer,
        advisor: Advisor | None,
    ) -> None:
        self.reference = Reference.of(options, views[0].scene)
        self.claims: tuple[Claim, ...] = ()
        if self.reference:  # it speaks of all of light and grade at once
            options = replace(options, top_k=max(options.top_k, _VALUES))
        self.options, self.observer = options, observer

        def proxy(scene: SceneData) -> Proxy:
            size = context.inner_size(scene, options, encoder)
            return Proxy(scene, size, device=str(encoder.device), seed=options.seed)

        self.vector, self.shots = gathered(views, options, proxy)
        self._widest = self._sizes()
        words = context.scene_words(*(view.scene for view in views))
        offline = OfflineAdvisor(prompt, words)
        self.offline, self.advisor = (
            beside(self.reference, each, prompt, len(views), words.lights)
            for each in (offline, advisor or offline)
        )
        self.several = options.variants > 1 and not options.baseline
        # Variants share what would be one vibe's time, as far as that goes.
        self.rounds = -(-options.rounds // 2) if self.several else options.rounds
        self.clock = Clock(self.rounds * (options.variants if self.several else 1), options.steps, observer)
        self.weights = weights_of(options)
        self._guidance = partial(make_guidance, encoder, heads, prompt, options)
        self._artists: list[Render] = []
        self._asked: object = None
        self.number = 0
        alone = len(self.shots) == 1 and not options.baseline
        self.looks = Looks(self.shots[0]) if alone and observer.wants_looks else None

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
        self.observer.look(self.looks.drawn(u, self._claims_of(advice.parsed)))

    def show(self, u: Tensor) -> None:
        """Shows the best look so far.

        Args:
            u: (N,) where a round has ended.
        """
        if self.looks:
            self.observer.look(self.looks.drawn(u, self.claims))

    def _claims_of(self, parsed: Parsed) -> tuple[Claim, ...]:
        """What words and picture claim of the first shot; of the others the same."""
        claims = claims_of(parsed, default_vocabulary())
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

    def confine(
        self, u: Tensor, earlier: Plan, start: Start | None, reach: float = 1.0, opening: float = 0.0
    ) -> Confined:
        """Lines 2 to 5 and 7 of Algorithm 1 at u: render, parse, compose, confine, project.

        Args:
            u: (N,) the point.
            earlier: The plan of the round before; empty for the first.
            start: Where this refinement started; None for the artist's scene.
            reach: How far from u the round may go, as a share of each component's feasible range.
            opening: By how much ranges that words name are wider than the plan's on either side, likewise.
        """
        self.renew(u, self.number)
        advice, plan = self._advise(u)
        plan = carry(plan, earlier)
        if self.options.baseline:
            plan = plan_everything(self.vector.instances, self.options.baseline)
        self._judge_by(advice, u)
        ranges = self._ranges(plan, u, opening)
        lower, upper = self.vector.bounds(ranges)
        if start and start.drawn is not None:
            lower, upper = starts.corral(start.u, lower, upper, start.drawn)
        lower, upper = around(u, lower, upper, reach)
        for shot in self.shots[1:]:
            shot.take(plan)
        return Confined(advice, plan, ranges, lower, upper, project(u, lower, upper), opening)

    def _ranges(self, plan: Plan, u: Tensor, opening: float) -> dict[str, tuple[Values, Values]]:
        """The plan's ranges at u (N,), those that words name opened; lamps stay so small that they touch nothing."""
        ranges = feasible_ranges(plan, self.vector.instances, self.vector.values(u))
        if opening:
            named = {key for key, entry in plan.items() if self._opens(key, entry)}
            share = torch.where(self.vector.mark(named), opening, 0.0)
            share = share.masked_fill(self.vector.mark(filter(self._is_measured, named)), math.inf)
            corners = opened(*self.vector.bounds(ranges), share, self.vector.encode({}))
            low, high = map(self.vector.plain, corners)
            ranges |= {key: (low[key], high[key]) for key in named}
        for key, widest in self._widest.items():
            low_end, high_end = ((min(end[0], widest),) for end in ranges[key])
            ranges[key] = low_end, high_end
        return ranges

    def _sizes(self) -> dict[str, float]:
        """Key of a lamp's size -> the most that it may be in any shot."""
        widest: dict[str, float] = {}
        for shot in self.shots:
            for own, size in headroom.sizes(shot.scene, shot.proxy.geometry).items():
                key = shot.names[own]
                widest[key] = min(widest.get(key, size), size)
        return widest

    def _opens(self, key: str, entry: PlanEntry) -> bool:
        """Whether a range may open while claims are missed: one that words name, but no finish, which is what its word says."""
        parameter = self.vector.instances[key].parameter
        finish = parameter.group == "material" and parameter.kind != "color"
        return entry.priority is not None and not (entry.prior or entry.usual or finish)

    def _is_measured(self, key: str) -> bool:
        """Whether a claim measures in the picture what a value of the grade sets, as a vignette: what is enough is its to say."""
        parameter = self.vector.instances[key].parameter
        measured = {claim.measure for claim in self.claims if claim.word and claim.part == "picture"}
        return parameter.group == "film" and parameter.name in measured

    def _judge_by(self, advice: Advice, u: Tensor) -> None:
        """Has pictures judged as this round's advice says; what the words claim is as understood at first, at u (N,)."""
        if not self._artists:  # the loop begins, at the artist's own values
            self._artists = [shot.draw(u) for shot in self.shots]
            self.observer.begin(self._artists[0].display.detach())
            if not self.options.baseline:
                self.claims = self._claims_of(advice.parsed)
            for shot, picture in zip(self.shots, self._artists, strict=True):
                begun = shot.begin(u, picture)
                shot.claims = None if self.options.baseline else ClaimSet.about(self.claims, begun)
        asked = advice.prompts, advice.parsed.targets, advice.parsed.colors
        if asked != self._asked:
            self._asked = asked
            for shot, picture in zip(self.shots, self._artists, strict=True):
                shot.guidance = self._guidance(advice, picture)

    def middle(self, now: Confined) -> Tensor:
        """(N,) another start: what is relevant stands in the middle of its range.

        Args:
            now: The round, confined.
        """
        movable = self.vector.mark(key for key, entry in now.plan.items() if entry.priority is not None)
        return torch.where(movable & (now.upper > now.lower), (now.lower + now.upper) / 2, now.u)

    def _advise(self, u: Tensor) -> tuple[Advice, Plan]:
        """The advice for the first shot at u (N,), and a plan with entries of the others for what only they have."""
        advice: Advice | None = None
        entries: dict[str, PlanEntry] = {}
        for shot in self.shots:
            if advice and all(key in entries for key in shot.names.values()):
                continue
            picture = shot.draw(u)
            now = context.plan_context(shot.proxy, shot.vector.values(u), picture)
            asked = self.advisor.advise(picture.display, shot.vector.instances, now)
            entries = {shot.names[own]: entry for own, entry in asked.plan.items()} | entries
            advice = advice or asked
        assert advice is not None
        return advice, Plan({key: entries[key] for key in self.vector.instances}, advice.plan.notes)

    def select(self, now: Confined, u: Tensor, shots: Sequence[ShotState] = ()) -> Selection:
        """What is minimized in a round, and over which parameters.

        Args:
            now: The round, confined.
            u: (N,) where the parameters are chosen.
            shots: Those that judge; all if there are none.
        """
        return select(
            now.plan,
            self.vector,
            shots or self.shots,
            u,
            now.lower,
            now.upper,
            self.options,
            self.weights,
            now.opening,
        )

    def descend(self, now: Confined, chosen: Selection) -> Descent:
        """Lines 8 to 15 of Algorithm 1, from the round's projected point.

        Args:
            now: The round, confined.
            chosen: S_K, and what is minimized; chosen at that point.
        """
        movable = self.vector.mark(chosen.keys) & (now.upper > now.lower)
        follow, steps = self.clock.follow(self.number), self.options.steps
        where = chosen.objective, now.u, movable, now.lower, now.upper
        if self.options.inner == "adam" or self.options.baseline:
            seed = self.options.seed * 1000 + self.number
            return descend(*where, steps, seed, step_settings(self.options), follow)
        if self.options.inner == "least-squares":
            return solve(*where, steps, follow, chosen.model)
        middle = self.options.inner == "middle"
        found = torch.where(movable, (now.lower + now.upper) / 2, now.u) if middle else now.u
        return Descent(found, 0.0, 0.0)
