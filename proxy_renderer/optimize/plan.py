# SPDX-License-Identifier: Apache-2.0
"""Which parameters a round optimizes, and how far each may go."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..planning.types import Plan
from ..schema import Instance, Values
from .vector import nearest_turn


def carry(plan: Plan, earlier: Plan) -> Plan:
    """The plan, with what an earlier round supported and this one no longer mentions held in its range.

    Without it a value would stay where the earlier round moved it, though its reason says otherwise.

    Args:
        earlier: The last round's; empty for the first.
    """
    gone = {k: e for k, e in earlier.items() if e.prior < 1.0 and plan[k].prior == 1.0}
    held = {key: replace(entry, priority=None) for key, entry in gone.items()}
    return Plan({**plan, **held}, plan.notes)


def feasible_ranges(
    plan: Plan, instances: Mapping[str, Instance], values: Mapping[str, Values]
) -> dict[str, tuple[Values, Values]]:
    """Key -> (lower, upper) of the plan, azimuths turned to where the values are now.

    Args:
        instances: The scene's parameters by key.
        values: Current values by key in schema units; the artist's where missing.
    """
    return {
        key: nearest_turn(instances[key], entry.lower, entry.upper, values.get(key, instances[key].value))
        for key, entry in plan.items()
    }
