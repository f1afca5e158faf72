# SPDX-License-Identifier: Apache-2.0
"""What the rounds of a vibe share, wherever they start: confiner, guidance, and what a round minimizes."""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import partial

import torch
from torch import Tensor

from ..guidance.encoder import Encoder
from ..guidance.guide import Guidance, PromptGuidance, Weights
from ..guidance.regions import Views
from ..planning.advice import Advice, Advisor, OfflineAdvisor
from ..prompt.types import Plan, PlanEntry
from ..render.proxy import Proxy, Render
from ..scene import SceneData
from ..schema import Values, VibeError
from ..schema.messages import Options
from . import context, starts
from .baseline import GlobalGuidance, plan_everything
from .inner import StepSettings, descend, fixed_views, promise
from .objective import RoundObjective
from .plan import carry, feasible_ranges, lock, top_k
from .progress import Clock, Observer
from .shots import ShotInput, ShotState, enter, share
from .vector import ParameterVector, project

INNER_SIZE, _LEAST_SIZE = 256, 192
"""Greatest longer side of the pictures inside the loop, in pixels, and the least however small the encoder's are."""


@dataclass
class Start:
    """Where a refinement starts. `drawn` (N,) are the components that were drawn at random, and stay near u (N,)."""

    u: Tensor
    drawn: Tensor | None = None


@dataclass
class Confined:
    """A round's parse, prompts and plan (steps 3 to 7 of Algorithm 1), and where they leave u (N,)."""

    advice: Advice
    plan: Plan
    ranges: dict[str, tuple[Values, Values]]
    lower: Tensor
    upper: Tensor
    u: Tensor


class Search:
    """One vibe. Arguments as for `pipeline.run`.

    Attributes:
        several: Whether variants are wanted.
        vector: The parameters of u.
        shots: What draws and judges it, one or several; the first one leads: plans are made for it.
        rounds: How many there are at most from each start.
        clock: Tells the observer how far all of it is.
        number: Of the current round, over all starts.
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
        self.options, self.observer = options, observer
        instances, names = share(views, ("camera", "film") if options.grade_each else ("camera",))
        self.vector = ParameterVector(lock(instances, options.groups, options.lock, options.camera))

        def proxy(scene: SceneData) -> Proxy:
            size = inner_size(scene, options, encoder)
            return Proxy(scene, size, device=str(encoder.device), seed=options.seed)

        self.shots = enter(views, names, self.vector, proxy)
        words = context.scene_words(*(view.scene for view in views))
        self.advisor = advisor or OfflineAdvisor(prompt, words)
        self.several = options.variants > 1 and not options.baseline
        # Variants share what would be one vibe's time, as far as that goes.
        self.rounds = -(-options.rounds // 2) if self.several else options.rounds
        self.clock = Clock(self.rounds * (options.variants if self.several else 1), options.steps, observer)
        self.weights = None if options.baseline else Weights()
        self._guidance = partial(make_guidance, encoder, heads, prompt, options)
        self.number = 0

    def find_starts(self) -> list[Start]:
        """The artist's scene; or the best of several starts after a coarse first pass, as different as they can be."""
        home = self.vector.encode({})
        number = starts.count(self.options)
        if number == 1:
            return [Start(home)]
        now = self.confine(home, Plan(), None)
        plan = starts.roam(self.vector.instances, now.plan) if self.several else now.plan
        ranges = feasible_ranges(plan, self.vector.instances, self.vector.values(home))
        box = self.vector.bounds(ranges)
        drawn = starts.draw_starts(self.vector, plan, now.u, box, number, self.options.seed)
        self.observer.stage(f"trying {number} starts")
        tried = []
        for point in drawn:
            tried.append(self._try(point, now))
            if self.observer.stopped():
                break
        losses = [loss for _, loss, _ in tried]
        if not self.several:
            return [Start(tried[min(range(len(tried)), key=losses.__getitem__)][0])]
        chosen = starts.most_diverse([display for _, _, display in tried], losses, self.options.variants)
        own = self.vector.mark(k for k, e in plan.items() if e.priority is not None and k != "film/exposure")
        return [Start(tried[i][0], own if i else None) for i in chosen]

    def _try(self, point: Tensor, now: Confined) -> tuple[Tensor, float, Tensor]:
        """A few steps from a start on few views: where they lead, its loss on all views, and its picture."""
        chosen, objective = self.objective(now, point, [_hasty(shot) for shot in self.shots])
        movable = self.vector.mark(chosen) & (now.upper > now.lower)
        steps, seed = starts.COARSE_STEPS, self.options.seed
        u = descend(
            objective, point, movable, now.lower, now.upper, steps, seed, StepSettings(), self._heedful
        ).u
        with torch.no_grad():
            pictures = [shot.draw(u) for shot in self.shots]
            losses = [_worth(shot, seen) for shot, seen in zip(self.shots, pictures, strict=True)]
        return u, sum(losses) / len(losses), pictures[0].display

    def _heedful(self, step: int, loss: float, picture: Render) -> bool:
        """Ends a loop that nobody follows when the artist says stop."""
        return self.observer.stopped()

    def renew(self, u: Tensor, number: int, **options: float) -> None:
        """Corrects the proxies at u (N,); see `Anchoring.renew`."""
        for shot in self.shots:
            shot.anchoring.renew(u, number, **options)

    def confine(self, u: Tensor, earlier: Plan, start: Start | None) -> Confined:
        """Parses, composes, confines and projects, at u (N,)."""
        self.renew(u, self.number)
        advice, plan = self._advise(u)
        plan = carry(plan, earlier)
        if self.options.baseline:
            plan = plan_everything(self.vector.instances)
        ranges = feasible_ranges(plan, self.vector.instances, self.vector.values(u))
        lower, upper = self.vector.bounds(ranges)
        if start and start.drawn is not None:
            lower, upper = starts.corral(start.u, lower, upper, start.drawn)
        if self.shots[0].guidance is None:  # the loop begins, at the artist's own values
            pictures = [shot.draw(u) for shot in self.shots]
            self.observer.begin(pictures[0].display.detach())
            for shot, picture in zip(self.shots, pictures, strict=True):
                shot.guidance = self._guidance(advice, picture)
        for shot in self.shots[1:]:
            shot.take(plan)
        return Confined(advice, plan, ranges, lower, upper, project(u, lower, upper))

    def _advise(self, u: Tensor) -> tuple[Advice, Plan]:
        """What to do at u (N,): as the first shot asks, and for what it does not show, as the others do."""
        advice: Advice | None = None
        entries: dict[str, PlanEntry] = {}
        for shot in self.shots:
            if advice and all(key in entries for key in shot.names.values()):
                continue
            picture = shot.draw(u)
            now = context.plan_context(shot.proxy, shot.vector.values(u), picture)
            found = self.advisor.advise(picture.display, shot.vector.instances, now)
            entries = {shot.names[own]: entry for own, entry in found.plan.items()} | entries
            advice = advice or found
        assert advice is not None
        return advice, Plan({key: entries[key] for key in self.vector.instances}, advice.plan.notes)

    def objective(
        self, now: Confined, u: Tensor, shots: Sequence[ShotState] = ()
    ) -> tuple[list[str], RoundObjective]:
        """S_K, and what is minimized over it, in these shots or in all."""
        seen = shots or self.shots
        chosen = select(now.plan, self.vector, seen, u, now.lower, now.upper, self.options)
        weight = pull(now.plan, self.vector, chosen)
        return chosen, RoundObjective(
            seen, self.vector, set(chosen), now.lower, now.upper, weight, self.weights
        )


def _hasty(shot: ShotState) -> ShotState:
    """The same shot, judged on few views."""
    guidance = copy(shot.guidance)
    assert guidance is not None
    guidance.views = Views(1, 1, 1)
    return replace(shot, guidance=guidance)


def _worth(shot: ShotState, picture: Render) -> float:
    assert shot.guidance is not None
    terms = shot.guidance(picture.display, picture.mask, fixed_views())
    return float(torch.stack([*terms.values()]).sum())


def make_guidance(
    encoder: Encoder, heads: Encoder | None, prompt: str, options: Options, advice: Advice, start: Render
) -> Guidance:
    """The objective's terms, calibrated on the artist's picture."""
    parsed = advice.parsed
    if options.baseline:
        return GlobalGuidance(encoder, prompt, Views())
    silhouette = any(a.entry == "silhouette" and not a.negated for a in parsed.attributes)
    first = (start.display, start.mask)
    return PromptGuidance(encoder, heads, advice.prompts, parsed.targets, parsed.colors, first, silhouette)


def select(
    plan: Plan,
    vector: ParameterVector,
    shots: Sequence[ShotState],
    u: Tensor,
    lower: Tensor,
    upper: Tensor,
    options: Options,
) -> list[str]:
    """S_K: the K parameters that gradients go to; the baseline's are all that can move."""
    movable = {key: bool((upper > lower)[part].any()) for key, part in vector.slices.items()}
    relevant = {key for key, entry in plan.items() if entry.priority is not None and movable[key]}
    if all(plan[key].prior > 0.0 for key in relevant):
        raise VibeError(
            "Nothing that the words name may change in this scene.",
            "Unlock something, allow more groups, or use other words.",
        )
    if options.baseline:
        return sorted(relevant)
    # Moving the camera means tracing everything again: only words are worth that.
    felt = {k for k in relevant if vector.instances[k].parameter.group != "camera" or plan[k].prior == 0.0}
    probe = RoundObjective(shots, vector, felt, lower, upper, torch.zeros_like(u), None)
    gain = promise(probe, u, lower, upper)
    return top_k(
        plan, options.top_k, movable, {k: float(gain[part].sum()) for k, part in vector.slices.items()}
    )


def pull(plan: Plan, vector: ParameterVector, chosen: list[str]) -> Tensor:
    """(N,) weight in [0, 1] of the prior: on what is optimized though no word named it."""
    weight = torch.zeros(vector.size, dtype=torch.float64)
    for key in chosen:
        weight[vector.slices[key]] = plan[key].prior
    return weight


def inner_size(scene: SceneData, options: Options, encoder: Encoder) -> tuple[int, int]:
    """Width and height of the pictures inside the loop; the prediction has the full size.

    Crops are at least three quarters of the picture, so one and a half times what the encoder looks at is enough;
    but highlights and shadows have to be there, however little it looks at.
    """
    enough = max(_LEAST_SIZE, encoder.size * 3 // 2)
    return context.picture_size(scene.resolution, min(options.size, INNER_SIZE, enough))
