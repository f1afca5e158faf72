# SPDX-License-Identifier: Apache-2.0
"""A further sentence begins with the picture of Cycles that the vibe before has ended with, if that still shows the scene."""

from dataclasses import replace

import pytest
import torch

from proxy_renderer.optimize.shots import ShotInput, gathered
from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.rigs.lighting import OFF
from proxy_renderer.scene import Light
from proxy_renderer.schema import FAMILIES, Instance
from proxy_renderer.schema.messages import Options

SIZE = (32, 24)


def picture(values, size):
    whole = torch.full((size[1], size[0], 3), 0.4)
    return CyclesPicture(whole, {"world": 0.5 * whole}, 0.5 * whole)


def begun(scene, source, known=None):
    _, (shot,) = gathered([ShotInput(scene, source, "", known)], Options(), lambda s: Proxy(s, SIZE))
    return shot


def with_values(scene, **values):
    changed = {
        key: replace(i, value=tuple(values[name] * v for v in i.value))
        for key, i in scene.instances.items()
        for name in values
        if i.parameter.name == name
    }
    assert changed
    return replace(scene, instances={**scene.instances, **changed})


@pytest.fixture
def ended(scene):
    shot = begun(scene, picture)
    return shot.anchored(shot.vector.encode({}), 0)


def never(values, size):
    raise AssertionError("a picture is known")


def asks(scene, known):
    asked = []

    def source(values, size):
        asked.append(values)
        return picture(values, size)

    shot = begun(scene, source, known)
    shot.anchored(shot.vector.encode({}), 0)
    return bool(asked)


def test_a_scene_that_stays_needs_no_other_picture(scene, ended):
    shot = begun(scene, never, ended.known_picture())
    u = shot.vector.encode({})
    assert torch.equal(shot.anchored(u, 0).draw(u).linear, ended.draw(u).linear)


def test_other_powers_and_grades_need_none_and_are_seen(scene, ended):
    brighter = with_values(scene, power=1.5, contrast=1.1)
    shot = begun(brighter, never, ended.known_picture())
    u = shot.vector.encode({})
    assert float(shot.anchored(u, 0).draw(u).linear.mean()) > 1.02 * float(
        ended.draw(ended.vector.encode({})).linear.mean()
    )


def test_what_rounding_changes_is_the_same(scene, ended):
    assert not asks(with_values(scene, roughness=1.0 + 1e-7), ended.known_picture())


@pytest.mark.parametrize(("kind", "power"), [("SUN", "strength"), ("AREA", "power")])
def test_a_light_that_the_sentence_adds_is_off_and_needs_none(scene, ended, kind, power):
    identity = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    added = Light("Vibe Rim", kind, identity, (0.0, 4.0, 3.0), added=True)
    values = {power: OFF, "color": (1.0, 1.0, 1.0), "azimuth": 180.0, "elevation": 40.0}

    def lit(brighter):
        own = {**values, power: OFF * brighter}
        made = [
            Instance(FAMILIES[f"light/{name}"], added.name, v if isinstance(v, tuple) else (v,))
            for name, v in own.items()
        ]
        instances = {**scene.instances, **{instance.key: instance for instance in made}}
        return replace(scene, lights=(*scene.lights, added), instances=instances)

    known = ended.known_picture()
    assert known.values_in(lit(1.0)) == {}
    assert known.values_in(lit(1000.0)) is None


def test_whatever_else_an_artist_has_changed_needs_a_new_picture(scene, ended):
    known = ended.known_picture()
    assert asks(with_values(scene, base_color=0.8), known)
    assert asks(with_values(scene, azimuth=0.7), known)
    assert asks(replace(scene, objects=tuple(replace(o, hidden=("shadow",)) for o in scene.objects)), known)
    assert asks(replace(scene, mesh=replace(scene.mesh)), known)
    assert asks(replace(scene, world=replace(scene.world, hidden=("camera",))), known)
    assert asks(replace(scene, lights=tuple(replace(x, shadow=not x.shadow) for x in scene.lights)), known)
