# SPDX-License-Identifier: Apache-2.0
"""From a sentence to what the optimiser may do: parse, compose, plan. Standard library only."""

from .attributes import ATTRIBUTES
from .explain import explain
from .parser import parse
from .planner import plan
from .prompts import compose
from .types import (
    Attribute,
    Parsed,
    PictureStats,
    Plan,
    PlanContext,
    PlanEntry,
    Prompts,
    SceneObject,
    SceneWords,
)

__all__ = [
    "ATTRIBUTES",
    "Attribute",
    "Parsed",
    "PictureStats",
    "Plan",
    "PlanContext",
    "PlanEntry",
    "Prompts",
    "SceneObject",
    "SceneWords",
    "compose",
    "explain",
    "parse",
    "plan",
]
