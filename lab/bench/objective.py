# SPDX-License-Identifier: Apache-2.0
"""The objective of a vibe, as a function of the picture alone: so Cycles' pictures can be judged as the proxy's are."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import torch
from torch import Tensor

from proxy_renderer.claims.claim import ClaimSet
from proxy_renderer.claims.from_goals import claims_of
from proxy_renderer.claims.measures.picture import MeasuredPicture
from proxy_renderer.goals.resolve import goals_or_why
from proxy_renderer.guidance.encoder import Encoder
from proxy_renderer.guidance.guide import Weights, claims_loss
from proxy_renderer.optimize.least_squares import fixed_views
from proxy_renderer.optimize.rounds.method import Method
from proxy_renderer.optimize.scene_facts import described, described_now
from proxy_renderer.planning.advice import OfflineAdvisor
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.words.lexicon.vocabulary import default_vocabulary
from proxy_renderer.words.parser import Understood

TERMS = ("similarity", "claims")
"""The parts of the objective: what the encoder says of regions, and what the words claim."""


def objective(proxy: Proxy, prompt: str, encoder: Encoder) -> Callable[[Tensor], Tensor]:
    """The objective of a prompt, as the loop has it at the artist's values, without what judges values and no picture.

    Where the subject is, and through how much fog it is seen, stays as it is there.

    Returns:
        Display picture (H, W, 3) → the weighted `TERMS` (2,), differentiable.

    Raises:
        VibeError: No word of the prompt is known.
    """
    scene = proxy.scene
    with torch.no_grad():
        picture, seen = proxy.render({}), proxy.gbuffer({})
        known, values = described(scene), {key: each.value for key, each in scene.instances.items()}
        now = described_now(known, proxy, values, picture)
        advice = OfflineAdvisor(goals_or_why(Understood(prompt, known))).advise(picture.display, scene.instances, now)
        guidance = Method().guidance(encoder, advice, picture, every_word=True)
        wanted = claims_of(advice.goals, default_vocabulary())
        claims = ClaimSet.about(wanted, MeasuredPicture(picture.display, seen))

    def terms(display: Tensor) -> Tensor:
        similarity = torch.stack(list(guidance(display, picture.mask, fixed_views()).values())).sum()
        residuals = claims.residuals(MeasuredPicture(display, seen))
        claimed = Weights.claims * claims_loss(residuals) if residuals else torch.zeros(())
        return torch.stack((similarity, claimed))

    return terms


def agreement(slopes: Mapping[str, Mapping[str, tuple[float, float]]]) -> dict[str, float]:
    """Similarity of the gradients of a scene's objective, over all of its parameters that were moved.

    Args:
        slopes: By parameter and term, the proxy's derivative and Cycles'.

    Returns:
        The cosine of the `whole` objective's gradients, and that of each term that either depends on.
    """
    table = torch.tensor([[row[term] for term in TERMS] for row in slopes.values()])  # (parameters, 2, 2)
    parts = {"whole": table.sum(1)} | {term: table[:, i] for i, term in enumerate(TERMS)}
    lengths = {name: part.norm(dim=0).prod() for name, part in parts.items()}
    return {
        name: round(float(part.prod(1).sum() / lengths[name]), 3) for name, part in parts.items() if lengths[name] > 0
    }
