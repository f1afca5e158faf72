# SPDX-License-Identifier: Apache-2.0
"""Which parameters a round optimizes, and how far each may go."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from ..planning.types import Plan
from ..schema import GROUPS, Instance, Values, VibeError, labels, matches
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


def lock(
    instances: Mapping[str, Instance], groups: Sequence[str], locks: Sequence[str], camera: bool
) -> dict[str, Instance]:
    """Instances with the artist's wishes in them: what may not change says why.

    Args:
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
