# SPDX-License-Identifier: GPL-3.0-or-later
"""Every type of light that Blender has is registered, in the schema's terms."""

import bpy
import pytest
import small_scenes as scenes
from vibe_render.core.journal import Journal
from vibe_render.core.schema_import import schema
from vibe_render.scene.light_types import EXTENTS, LIGHT_TYPES
from vibe_render.scene.orbits import Pose


def test_all_types_of_blender_are_registered():
    assert set(LIGHT_TYPES) == set(bpy.types.Light.bl_rna.properties["type"].enum_items.keys())


@pytest.mark.parametrize("name", LIGHT_TYPES)
def test_its_parameters_are_the_schemas(name):
    kind = LIGHT_TYPES[name]
    theirs = {p.name for p in schema.PARAMETERS if p.group == "light" and (not p.only or name in p.only)}
    assert {kind.energy, kind.extent.parameter} <= theirs
    assert ("distance" in theirs) == kind.has_position
    assert schema.radiometry.unit_energy(name) > 0


@pytest.mark.parametrize("name", LIGHT_TYPES)
def test_only_lights_with_a_position_move_on_their_orbit(scene, name):
    lamp = scenes.light(scene, name)
    scene.view_layers[0].update()
    before, pose = lamp.location.copy(), Pose.of(lamp, lamp.location * 0)
    pose.azimuth += 40.0
    pose.apply(Journal())
    scene.view_layers[0].update()
    assert (lamp.location != before) == LIGHT_TYPES[name].has_position
    assert Pose.of(lamp, lamp.location * 0).azimuth == pytest.approx(pose.azimuth, abs=1e-3)


@pytest.mark.parametrize("extent", EXTENTS, ids=lambda extent: extent.parameter)
def test_extents_are_inverted(extent):
    assert extent.from_angle(extent.to_angle(0.3)) == pytest.approx(0.3)
