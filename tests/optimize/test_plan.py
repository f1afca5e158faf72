# SPDX-License-Identifier: Apache-2.0
"""Which parameters a round may touch: relevant first, then ranked; locks always win."""

import pytest

from proxy_renderer.optimize.rounds.confiner import carry
from proxy_renderer.optimize.shots import lock
from proxy_renderer.optimize.vector import feasible_ranges
from proxy_renderer.planning.types import Plan, PlanEntry
from proxy_renderer.schema import FAMILIES, Instance, VibeError


def instances():
    rows = [("material/roughness", "Body"), ("light/power", "Key"), ("camera/azimuth", ""), ("film/contrast", "")]
    made = [Instance(FAMILIES[f], owner, (FAMILIES[f].default,)) for f, owner in rows]
    return {i.key: i for i in made}


def test_locks_say_why():
    locked = lock(instances(), [], ["light/Key"], camera=False)
    assert {k: bool(i.locked) for k, i in locked.items()} == {
        "material/Body/roughness": False,
        "light/Key/power": True,
        "camera/azimuth": True,
        "film/contrast": False,
    }
    assert locked["light/Key/power"].locked == "locked by you"


def test_the_camera_moves_when_asked():
    assert not lock(instances(), [], [], camera=True)["camera/azimuth"].locked
    assert not lock(instances(), ["camera"], [], camera=False)["camera/azimuth"].locked
    assert lock(instances(), [], ["camera"], camera=True)["camera/azimuth"].locked


def test_groups_hold_the_others():
    locked = lock(instances(), ["film"], [], camera=False)
    assert [k for k, i in locked.items() if not i.locked] == ["film/contrast"]


def test_unknown_groups_and_locks_are_refused():
    with pytest.raises(VibeError, match="Unknown group 'lights'"):
        lock(instances(), ["lights"], [], camera=False)
    with pytest.raises(VibeError, match="matches nothing") as caught:
        lock(instances(), [], ["light/Lamp"], camera=False)
    assert "light/Key" in caught.value.remedy


def test_ranges_of_azimuths_follow_the_value():
    sun = Instance(FAMILIES["light/azimuth"], "Sun", (-170.0,))
    plan = Plan({sun.key: PlanEntry((180.0,), (200.0,), 0, "from behind")})
    assert feasible_ranges(plan, {sun.key: sun}, {})[sun.key] == ((-180.0,), (-160.0,))


def test_what_an_earlier_round_moved_keeps_its_range_and_reason():
    support = PlanEntry((0.2,), (0.4,), 12, "supports", prior=0.5)
    named, renamed = (PlanEntry((0.0,), (high,), 1, "'matte'", prior=0.0) for high in (0.1, 0.2))
    untouched = PlanEntry((0.0,), (1.0,), None, "untouched")
    plan = Plan({"a": support, "b": named})
    for _ in range(2):
        plan = carry(Plan({"a": untouched, "b": renamed}), plan)
    assert (plan["a"].upper, plan["a"].reason, plan["a"].priority) == ((0.4,), "supports", None)
    assert plan["b"] == renamed
