# SPDX-License-Identifier: Apache-2.0
"""What pictures are judged by in the rounds: the guidance for a prompt, and how much each term of the loss counts."""

from __future__ import annotations

from dataclasses import replace

from ...guidance.encoder import Encoder
from ...guidance.guide import Guidance, NoGuidance, PromptGuidance, Weights
from ...guidance.regions import Views
from ...planning.advice import Advice
from ...render.proxy import Render
from ...schema.messages import Options
from ..baseline import GlobalGuidance


def weights_of(options: Options) -> Weights:
    """Of the loss: the baseline has similarity alone.

    Attribute heads only count where claims do not: those measure the same classes, which heads guess. A head that is wrong about
    a "dusty pink" outweighs the claim that is right about it, and draws the paint away.
    """
    if options.baseline:
        return replace(Weights(), claims=0.0, prior=0.0, hue=0.0)
    weights = Weights().without(options.leave_out)
    return replace(weights, attributes=0.0) if weights.claims else weights


def make_guidance(
    encoder: Encoder, heads: Encoder | None, prompt: str, options: Options, advice: Advice, start: Render
) -> Guidance:
    """The guidance for a prompt; the baseline's is L_pos(I, t) alone.

    Args:
        encoder: Judges similarity.
        heads: Encoder whose attribute heads are asked; None for none.
        prompt: What the artist typed.
        options: Whether it is the baseline's.
        advice: The composed captions, and what the words ask for.
        start: The artist's picture, on which the guidance is calibrated.
    """
    goals = advice.goals
    if options.baseline:
        return GlobalGuidance(encoder, prompt, Views())
    if not prompt.strip():  # a picture is there in their place, and its claims say all
        return NoGuidance()
    silhouette = any(a.entry == "silhouette" and not a.negated for a in goals.parsed.attributes)
    first = (start.display, start.mask)
    # The paper's full-image term has the raw text.
    prompts = replace(advice.prompts, whole=prompt) if options.inner == "adam" else advice.prompts
    return PromptGuidance(encoder, heads, prompts, goals.classes, {}, first, silhouette, weights_of(options))
