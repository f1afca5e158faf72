# SPDX-License-Identifier: GPL-3.0-or-later
"""Cameras and lights on their orbit around the subject (formulas in schema/orbit.py)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from bpy.types import Object
from mathutils import Matrix, Vector

from ..core.journal import Journal
from ..core.schema_import import schema
from ..core.value_slots import PropertySlot
from .light_types import type_of


def orbit_matrix(pivot: Sequence[float] | np.ndarray, azimuth: float, elevation: float, distance: float) -> Matrix:
    """World matrix of a camera or light on an orbit (angles in degrees, see `schema.orbit`), looking at the pivot."""
    rotation = Matrix(schema.orbit.frame(azimuth, elevation)).to_4x4()
    place = Vector(pivot) + distance * Vector(schema.orbit.direction(azimuth, elevation))
    return Matrix.Translation(place) @ rotation


@dataclass
class Pose:
    """The place and rotation of a camera or light relative to the pivot (world space)."""

    obj: Object
    pivot: Vector
    azimuth: float  # degrees, as the elevation
    elevation: float
    distance: float  # meters
    residual: Matrix  # rotation of the object relative to looking straight at the pivot; kept when the object moves

    @classmethod
    def of(cls, obj: Object, pivot: Vector) -> Pose:
        """The object's present pose; a sun counts as placed in the direction that its light comes from."""
        if obj.parent or obj.constraints:
            rotation = obj.matrix_world.to_3x3().normalized()
        elif obj.rotation_mode == "QUATERNION":
            rotation = obj.rotation_quaternion.normalized().to_matrix()
        elif obj.rotation_mode == "AXIS_ANGLE":
            angle, *axis = obj.rotation_axis_angle
            rotation = Matrix.Rotation(angle, 3, Vector(axis))
        else:
            rotation = obj.rotation_euler.to_matrix()
        offset = obj.matrix_world.translation - pivot
        toward = type_of(obj).offset(obj, pivot, rotation) if obj.type == "LIGHT" else offset
        azimuth, elevation = schema.orbit.angles(toward)
        residual = Matrix(schema.orbit.frame(azimuth, elevation)).transposed() @ rotation
        return cls(obj, pivot, azimuth, elevation, max(offset.length, 1e-6), residual)

    def apply(self, journal: Journal) -> None:
        """Moves and turns the object to the pose."""
        rotation = Matrix(schema.orbit.frame(self.azimuth, self.elevation)) @ self.residual
        if self.obj.type != "LIGHT" or type_of(self.obj).has_position:
            direction = Vector(schema.orbit.direction(self.azimuth, self.elevation))
            PropertySlot(self.obj, "location").set(journal, tuple(self.pivot + self.distance * direction))
        mode = self.obj.rotation_mode
        if mode == "QUATERNION":
            PropertySlot(self.obj, "rotation_quaternion").set(journal, tuple(rotation.to_quaternion()))
        elif mode == "AXIS_ANGLE":
            axis, angle = rotation.to_quaternion().to_axis_angle()
            PropertySlot(self.obj, "rotation_axis_angle").set(journal, (angle, *axis))
        else:
            euler = rotation.to_euler(mode, self.obj.rotation_euler)
            PropertySlot(self.obj, "rotation_euler").set(journal, tuple(euler))
