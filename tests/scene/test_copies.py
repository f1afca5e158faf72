# SPDX-License-Identifier: Apache-2.0
"""Copies of materials in an exported scene: they start as their source, and are only on their objects."""

from dataclasses import replace

import numpy as np

from lab.bench.scenes import balls
from proxy_renderer.optimize.shots import lock
from proxy_renderer.schema.material_copies import copy_name


def test_a_copy_is_on_its_objects_with_the_values_of_its_source():
    scene = balls(2, 1, 1)
    shared = replace(scene, mesh=replace(scene.mesh, material=np.zeros_like(scene.mesh.material)))
    name = copy_name("Ball 0", ["Floor"])
    split = shared.with_copies({name: ("Floor",), copy_name("Ball 0", ["Gone"]): ("Gone",)})
    assert [m.name for m in split.materials] == ["Ball 0", "Floor", name]
    assert {*split.mesh.material[split.mesh.object == 1]} == {2}
    assert {*split.mesh.material[split.mesh.object == 0]} == {0}
    assert {m.name: m.role for m in split.materials} == {
        "Ball 0": "subject",
        "Floor": "surroundings",
        name: "surroundings",
    }
    for key, instance in shared.instances.items():
        if instance.owner == "Ball 0":
            twin = split.instances[instance.parameter.key(name)]
            assert (twin.value, twin.role) == (instance.value, "surroundings")
            assert split.instances[key].role == "subject"
    assert shared.with_copies({}) is shared


def test_a_lock_on_a_material_holds_for_its_copies():
    scene = balls(2, 1, 1)
    key = f"material/{copy_name('Ball 0', ['Ball 0'])}/roughness"
    split = scene.with_copies({copy_name("Ball 0", ["Ball 0"]): ("Ball 0",)})
    assert lock(split.instances, (), ["material/Ball 0"], camera=False)[key].locked
    assert not lock(split.instances, (), ["material/Floor"], camera=False)[key].locked
