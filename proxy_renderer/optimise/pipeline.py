# SPDX-License-Identifier: Apache-2.0
"""Algorithm 1 of the paper: parse, compose, confine, select, project, inner steps, stabilise.

Every round is anchored: it works with a proxy that Cycles has corrected where the round starts.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

import torch
from torch import Tensor

from ..guidance.encoder import Encoder
from ..guidance.guide import Guide, Weights
from ..guidance.regions import Views
from ..language.advice import Advisor, OfflineAdvisor
from ..language.types import Parsed, Plan, Prompts
from ..render.proxy import Proxy
from ..scene import SceneData
from ..schema import Values, VibeError
from ..schema.messages import Options
from . import context
from .anchoring import Anchoring, Source
from .baseline import GlobalGuide, plan_everything
from .inner import Settings, descend, promise
from .objective import RoundObjective, Terms, draw
from .plan import carry, feasible_ranges, lock, top_k
from .progress import Clock, Watch
from .vector import ParameterVector, project

INNER_SIZE = 256
"""Greatest longer side of the pictures inside the loop, in pixels."""

STRIDE = 0.05
"""A projection that moves no value by more than this share of its whole range is not worth another anchor."""

CONVERGED = 0.005
"""A round, other than the first, that lowers the loss by a smaller share is the last one."""


@dataclass
class Outcome:
    """What a vibe found.

    Attributes:
        vector: The parameters of u.
        u: The values found, see `ParameterVector.values`.
        plan: The last round's plan.
        ranges: The last round's (lower, upper) by key, azimuths turned as the values are.
        optimised: Keys that some round optimised.
        parsed: The prompt, understood.
        prompts: What the encoder was asked.
        rounds: One record per round: parameters, loss at start and end, its terms, steps, seconds.
        anchoring: The proxy's corrections.
        stopped: Whether the watcher ended the loop.
    """

    vector: ParameterVector
    u: Tensor
    plan: Plan
    ranges: dict[str, tuple[Values, Values]]
    optimised: set[str]
    parsed: Parsed
    prompts: Prompts
    anchoring: Anchoring
    rounds: list[dict[str, Any]] = field(default_factory=list)
    stopped: bool = False


def run(
    scene: SceneData,
    prompt: str,
    options: Options,
    encoder: Encoder,
    heads: Encoder | None,
    watch: Watch,
    advisor: Advisor | None = None,
    source: Source | None = None,
) -> Outcome:
    """Finds the values that make the scene look like the prompt.

    Args:
        scene: The exported scene.
        prompt: What the artist typed.
        options: Budget, seed, locks; the same options give the same values, bit for bit, on a CPU.
        encoder: Judges similarity.
        heads: Encoder whose attribute heads guide beside it; None for none.
        watch: Follows the loop, and may end it.
        advisor: Parses, composes and confines; None for the offline planner.
        source: Cycles' pictures of values, which correct the proxy; None for none.

    Raises:
        VibeError: If no word of the prompt is known, or nothing that the words touch may change.
    """
    vector = ParameterVector(lock(scene.instances, options.groups, options.lock, options.camera))
    proxy = Proxy(scene, inner_size(scene, options, encoder), device=str(encoder.device), seed=options.seed)
    advisor = advisor or OfflineAdvisor(prompt, context.scene_words(scene))
    anchoring = Anchoring(proxy, vector, source)
    clock = Clock(options, watch)
    u = vector.encode({})
    plan = Plan()
    terms: Terms | None = None
    weights = None if options.baseline else Weights()
    rounds: list[dict[str, Any]] = []

    for number in range(options.rounds):
        started = time.monotonic()
        anchoring.renew(u, number)
        picture = draw(proxy, vector, u)
        values = vector.values(u)
        now = context.plan_context(proxy, values, picture)
        advice = advisor.advise(picture.display, vector.instances, now)  # parse, compose, confine
        parsed, prompts, plan = advice.parsed, advice.prompts, carry(advice.plan, plan)
        if options.baseline:
            plan = plan_everything(vector.instances)
        ranges = feasible_ranges(plan, vector.instances, values)
        lower, upper = vector.bounds(ranges)
        u = project(u, lower, upper)
        anchoring.renew(u, number, slack=STRIDE)

        terms = terms or guidance(encoder, heads, parsed, prompts, prompt, options, picture)
        chosen = select(plan, vector, proxy, terms, u, lower, upper, options)
        objective = RoundObjective(
            proxy, vector, terms, set(chosen), lower, upper, pull(plan, vector, chosen), weights
        )
        movable = vector.mark(chosen) & (upper > lower)
        seed = options.seed * 1000 + number
        found = descend(
            objective, u, movable, lower, upper, options.steps, seed, Settings(), clock.follow(number)
        )
        u = found.u

        rounds.append(
            {
                "parameters": chosen,
                "loss": [found.start_loss, found.loss],
                **objective.account(u),
                "steps": found.steps,
                "repairs": found.repairs,
                "advice": advice.source,
                "seconds": round(time.monotonic() - started, 3),
            }
        )
        gained = found.start_loss - found.loss
        if clock.stopped or not chosen or (number and gained < CONVERGED * abs(found.start_loss)):
            break

    anchoring.renew(u, len(rounds) - 1)
    optimised = {key for record in rounds for key in record["parameters"]}
    return Outcome(vector, u, plan, ranges, optimised, parsed, prompts, anchoring, rounds, clock.stopped)


def guidance(
    encoder: Encoder,
    heads: Encoder | None,
    parsed: Parsed,
    prompts: Prompts,
    prompt: str,
    options: Options,
    start: Any,
) -> Terms:
    """The objective's terms, calibrated on the artist's picture; they are the same in all rounds."""
    if options.baseline:
        return GlobalGuide(encoder, prompt, Views())
    silhouette = any(a.entry == "silhouette" and not a.negated for a in parsed.attributes)
    first = (start.display, start.mask)
    return Guide(encoder, heads, prompts, parsed.targets, parsed.colors, first, silhouette)


def select(
    plan: Plan,
    vector: ParameterVector,
    proxy: Proxy,
    terms: Terms,
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
    probe = RoundObjective(proxy, vector, terms, felt, lower, upper, torch.zeros_like(u), None)
    gain = promise(probe, u, lower, upper)
    return top_k(
        plan, options.top_k, movable, {k: float(gain[part].sum()) for k, part in vector.slices.items()}
    )


def pull(plan: Plan, vector: ParameterVector, chosen: list[str]) -> Tensor:
    """(N,) weight in [0, 1] of the prior: on what is optimised though no word named it."""
    weight = torch.zeros(vector.size, dtype=torch.float64)
    for key in chosen:
        weight[vector.slices[key]] = plan[key].prior
    return weight


def inner_size(scene: SceneData, options: Options, encoder: Encoder) -> tuple[int, int]:
    """Width and height of the pictures inside the loop; the prediction has the full size.

    Crops are at least three quarters of the picture, so one and a half times what the encoder looks
    at is enough: 192 pixels for the embedded one.
    """
    return context.picture_size(scene.resolution, min(options.size, INNER_SIZE, encoder.size * 3 // 2))
