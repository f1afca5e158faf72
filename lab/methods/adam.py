# SPDX-License-Identifier: Apache-2.0
"""The paper's inner loop: Adam inside the feasible box, stabilized (Algorithm 1, lines 8 to 15)."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Protocol

import torch
from torch import Tensor

from lab.methods import RATE
from proxy_renderer.guidance.encoder import Encoder
from proxy_renderer.guidance.guide import Guidance
from proxy_renderer.optimize.least_squares import Descent, fixed_views
from proxy_renderer.optimize.objective import RoundObjective
from proxy_renderer.optimize.rounds.confiner import Confined
from proxy_renderer.optimize.rounds.method import Method
from proxy_renderer.optimize.rounds.selection import Selection
from proxy_renderer.optimize.vector import project
from proxy_renderer.planning.advice import Advice
from proxy_renderer.render.proxy import Render


class Objective(Protocol):
    """Pictures of u, and how far they are from the words."""

    @property
    def shots(self) -> int:
        """Number of pictures: steps take them in turn, points are judged on all of them."""

    def render(self, u: Tensor, shot: int) -> Any:
        """A picture of u, differentiable in what may move.

        Args:
            u: (N,) in [0, 1].
            shot: Which picture, from 0.
        """

    def loss(self, picture: Any, u: Tensor, generator: torch.Generator, shot: int) -> Tensor:
        """Distance of a picture from the words.

        Args:
            picture: As `render` returns it.
            u: (N,) the values that it shows.
            shot: Which picture it is, from 0.

        Returns:
            A scalar, differentiable in the picture and in u.
        """


@dataclass(frozen=True)
class StepSettings:
    """Steps of the inner loop.

    Attributes:
        rate: Greatest step, as a share of each component's feasible range; it falls to a tenth of
            that along half a cosine.
        clip: Greatest gradient norm.
        every: Steps between two evaluations on the fixed views.
        progress: How much lower a loss must be to count as progress.
        patience: Evaluations without progress after which the loop ends.
        repairs: Non-finite losses after which the loop gives up.
    """

    rate: float = 0.04
    clip: float = 1.0
    every: int = 4
    progress: float = 2e-3
    patience: int = 3
    repairs: int = 4


class Adam(Method):
    """The product's plan, claims and selection, and the paper's loop and raw text.

    Attributes:
        settings: Of the loop; `lab.methods.RATE` in the environment has another rate.
    """

    settings = StepSettings()

    def __init__(self) -> None:
        rate = int(os.environ.get(RATE, "0"))
        if rate:
            self.settings = replace(self.settings, rate=rate / 1000)

    def guidance(self, encoder: Encoder, advice: Advice, start: Render, every_word: bool = False) -> Guidance:
        """The product's, but the paper's full-image term has the raw text."""
        raw = replace(advice, prompts=replace(advice.prompts, whole=advice.goals.parsed.prompt))
        return super().guidance(encoder, raw, start, every_word=True)

    def descend(
        self, now: Confined, chosen: Selection, steps: int, seed: int, follow: Callable[[int, float, Any], bool]
    ) -> Descent:
        """Lines 8 to 15 of the paper."""
        where = SampledObjective(chosen.objective), now.u, chosen.movable(now), now.lower, now.upper
        return descend(*where, steps, seed, self.settings, follow)


class SampledObjective:
    """A round's objective on views that are drawn anew for each step, see `Objective`."""

    def __init__(self, objective: RoundObjective) -> None:
        self._objective = objective

    @property
    def shots(self) -> int:
        """Number of pictures."""
        return len(self._objective.seen)

    def render(self, u: Tensor, shot: int) -> Render:
        """The proxy's picture of u (N,), of a shot."""
        return self._objective.seen[shot].draw(u, self._objective.free)

    def loss(self, picture: Render, u: Tensor, generator: torch.Generator, shot: int) -> Tensor:
        """The sum of all terms. Arguments as for `Objective.loss`."""
        terms = self._objective.terms(picture, generator, shot)
        total = sum(terms.values(), picture.display.new_zeros(()))
        return total + self._objective.held(u).to(total)


def descend(
    objective: Objective,
    u: Tensor,
    chosen: Tensor,
    lower: Tensor,
    upper: Tensor,
    steps: int,
    seed: int,
    settings: StepSettings,
    on_step: Callable[[int, float, Any], bool],
) -> Descent:
    """Minimizes the objective over the chosen components.

    Args:
        u: (N,) start, inside the box.
        chosen: (N,) bool, the components that may move.
        lower: (N,) lower corner of the feasible box.
        upper: (N,) upper corner.
        on_step: Called with (step from 1, loss, picture) after each step; True ends the loop.
    """
    if not chosen.any():
        return Descent(u.clone(), 0.0, 0.0)
    span = (upper - lower)[chosen]
    generator = torch.Generator().manual_seed(seed)

    def place(position: Tensor) -> Tensor:
        """u with the chosen components at these positions within their ranges."""
        return u.index_put((chosen.nonzero(as_tuple=True)[0],), lower[chosen] + span * position)

    def judge(point: Tensor, picture: Any, drawn: int) -> float:
        """The mean loss over all shots, of which one is drawn already."""
        losses = []
        with torch.no_grad():
            for shot in range(objective.shots):
                shown = picture if shot == drawn else objective.render(point, shot)
                losses.append(float(objective.loss(shown, point, fixed_views(), shot)))
        return sum(losses) / len(losses)

    best = Descent(u.clone(), math.inf, math.inf)
    position, optimizer = _restart(((u - lower)[chosen] / span).clone(), settings.rate)
    stale = 0
    for step in range(1, steps + 2):  # line 8; the last turn only judges
        point, shot = place(position), (step - 1) % objective.shots
        picture = objective.render(point, shot)  # line 9
        if (step - 1) % settings.every == 0 or step > steps:
            score = judge(point.detach(), picture, shot)
            best.start_loss = score if step == 1 else best.start_loss
            stale = 0 if score < best.loss - settings.progress else stale + 1
            if score < best.loss:
                best.u, best.loss = point.detach().clone(), score
        if step > steps or stale > settings.patience:
            break
        loss = objective.loss(picture, point, generator, shot)  # lines 10 to 12
        best.steps = step
        if _backward(loss, position, settings.clip):  # line 13, and 14: clip, project, repair
            optimizer.param_groups[0]["lr"] = _rate(settings.rate * 0.5**best.repairs, step, steps)
            optimizer.step()
            with torch.no_grad():
                position.copy_(project(position, torch.zeros_like(position), torch.ones_like(position)))
        else:
            best.repairs += 1
            calmer = settings.rate * 0.5**best.repairs
            position, optimizer = _restart((best.u - lower)[chosen] / span, calmer)
        if on_step(step, float(loss.detach()), picture) or best.repairs > settings.repairs:
            break
    return best


def _restart(position: Tensor, rate: float) -> tuple[Tensor, torch.optim.Adam]:
    position = torch.nan_to_num(position.detach(), 0.0).clamp(0.0, 1.0).requires_grad_()
    return position, torch.optim.Adam([position], lr=rate, betas=(0.8, 0.98), foreach=False)


def _rate(rate: float, step: int, steps: int) -> float:
    return rate * (0.1 + 0.9 * 0.5 * (1.0 + math.cos(math.pi * (step - 1) / steps)))


def _backward(loss: Tensor, position: Tensor, clip: float) -> bool:
    """Fills the clipped gradient; False if the loss or the gradient is not finite."""
    if not torch.isfinite(loss):
        return False
    position.grad = None
    loss.backward()
    if position.grad is None or not torch.isfinite(position.grad).all():
        return False
    torch.nn.utils.clip_grad_norm_([position], clip)
    return True
