# SPDX-License-Identifier: Apache-2.0
"""How a vibe is carried out: what the command line, the panel and the engine call by the same names."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from .budgets import STANDARD
from .errors import VibeError


@dataclass(frozen=True)
class Options:
    """How a vibe is carried out.

    Attributes:
        rounds: Outer rounds of Algorithm 1: the plan is made anew in each.
        steps: Gradient steps in each round.
        size: Longer side of the prediction, pixels.
        top_k: How many parameters a round may optimize.
        seed: Seed of every random choice.
        groups: Parameter groups that may change; empty for all of them (the camera only if named).
        lock: Patterns of parameters that must not change: a group, "light/Key", or a glob.
        encoder: An open_clip hub tag or local checkpoint; "" for the embedded encoder.
        device: A torch device, or "auto".
        baseline: "" for the product, "clip-only" for the paper's baseline.
        camera: Whether the camera may be optimized though `groups` does not name it.
        vlm_model: A vision-language model that parses, plans and judges; "" for the environment's
            VIBE_VLM_MODEL (none if that is not set), "off" for none.
        vlm_url: Base URL of its OpenAI-compatible endpoint; "" for the environment's.
        online: Whether other computers may be reached; a model on this one always may.
        anchor: Whether Cycles renders small pictures meanwhile, which correct the proxy.
        starts: Points that a coarse first pass tries; 1 for the artist's scene alone. Variants raise it.
        variants: How many different looks to find for the same words.
        grade_each: Whether each of several shots has a grade and exposure of its own.
    """

    rounds: int = STANDARD.rounds
    steps: int = STANDARD.steps
    size: int = STANDARD.size
    top_k: int = 8
    seed: int = 0
    groups: tuple[str, ...] = ()
    lock: tuple[str, ...] = ()
    encoder: str = ""
    device: str = "auto"
    baseline: str = ""
    camera: bool = False
    vlm_model: str = ""
    vlm_url: str = ""
    online: bool = True
    anchor: bool = True
    starts: int = STANDARD.starts
    variants: int = 1
    grade_each: bool = False

    @classmethod
    def from_dict(cls, raw: dict[str, Any]) -> Options:
        """Options from their JSON form; raises VibeError for a name that is not one."""
        known = {f.name for f in fields(cls)}
        if strange := sorted(set(raw) - known):
            raise VibeError(f"Unknown option {strange[0]!r}.", f"Use one of: {', '.join(sorted(known))}.")
        lists: dict[str, Any] = {name: tuple(raw[name]) for name in ("groups", "lock") if name in raw}
        return cls(**{**raw, **lists})
