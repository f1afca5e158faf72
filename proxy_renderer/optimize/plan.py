# SPDX-License-Identifier: Apache-2.0
"""Which parameters a round optimizes, and how far each may go."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

from ..prompt.types import Plan
from ..schema import GROUPS, Instance, Values, VibeError, labels, matches
from .vector import nearest_turn

_OCTAVE = 1.5
_FAINTEST = 2.0**-20


def top_k(
    plan: Plan, k: int, movable: Mapping[str, bool], first_order_gain: Mapping[str, float]
) -> list[str]:
    """The K most important of the relevant parameters (equation 7), refined by how much they can still lower the loss.

    Those without a priority, and those that cannot move, are dropped before anything is ranked.
    Among the others, half the gain costs one and a half places: a parameter at the right
    end of its range, or where the loss is flat, makes room for one that still helps.

    Args:
        plan: Entries by key; a smaller priority is more important, None is irrelevant.
        k: How many keys at most; a color counts as one.
        movable: Key -> whether its feasible range is more than a point.
        first_order_gain: Key -> how much the loss could fall, to first order, by moving it within its range.
    """
    most = max(first_order_gain.values(), default=0.0)

    def rank(key: str) -> tuple[float, str]:
        share = first_order_gain.get(key, 0.0) / most if most > 0.0 else 1.0
        return (plan[key].priority or 0) - _OCTAVE * math.log2(max(share, _FAINTEST)), key

    relevant = [key for key, entry in plan.items() if entry.priority is not None and movable[key]]
    return sorted(relevant, key=rank)[:k]


def carry(plan: Plan, earlier: Plan) -> Plan:
    """The plan, with what an earlier round supported and this one no longer mentions held in its range.

    Without it a value would stay where the earlier round moved it, though its reason says otherwise.

    Args:
        plan: This round's.
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
        plan: The round's.
        instances: The scene's parameters by key.
        values: Current values by key in schema units; the artist's where missing.
    """
    return {
        key: nearest_turn(instances[key], entry.lower, entry.upper, values.get(key, instances[key].value))
        for key, entry in plan.items()
    }


def lock(
    instances: Mapping[str, Instance], groups: Sequence[str], locks: Sequence[str], camera: bool
) -> dict[str, Instance]:
    """Instances with the artist's wishes in them: what may not change says why.

    Args:
        instances: By key.
        groups: Groups that may change; empty for all but the camera.
        locks: Patterns of what must stay, see `schema.matches`.
        camera: Whether the camera may move though no group names it.

    Raises:
        VibeError: For a group that does not exist and a pattern that nothing matches.
    """
    check_groups(groups)
    for pattern in locks:
        if not any(matches(key, [pattern]) for key in instances):
            owners = sorted({key.rpartition("/")[0] for key in instances if key.count("/") > 1})
            raise VibeError(
                f"The lock {pattern!r} matches nothing in this scene.",
                f"Lock a group ({', '.join(GROUPS)}), one thing ({', '.join(owners[:4])}) or a glob (*/roughness).",
            )

    def reason(key: str, group: str) -> str:
        if matches(key, list(locks)):
            return "locked by you"
        if group == "camera" and "camera" not in groups and not camera:
            return "the camera stays as you framed it"
        if groups and group not in groups and not (group == "camera" and camera):
            return f"{labels.GROUP_TITLES[group]} may not change"
        return ""

    return {
        key: replace(i, locked=i.locked or reason(key, i.parameter.group)) for key, i in instances.items()
    }


def check_groups(groups: Sequence[str]) -> None:
    """Makes sure that all groups exist.

    Raises:
        VibeError: For one that does not.
    """
    if strange := [g for g in groups if g not in GROUPS]:
        raise VibeError(f"Unknown group {strange[0]!r}.", f"Use some of: {', '.join(GROUPS)}.")
