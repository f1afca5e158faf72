# SPDX-License-Identifier: Apache-2.0
"""The camera against trigonometry: a field of view of 90 degrees sees as far aside as ahead."""

from __future__ import annotations

import dataclasses
import math

import pytest
import torch
from operation_tests import OperationTests, number
from torch import Tensor

from lab.bench.scenes import balls
from proxy_renderer.render.geometry import camera
from proxy_renderer.render.geometry.camera import View, view_of
from proxy_renderer.scene.values import RenderValues
from proxy_renderer.schema import orbit

SIZE = (64, 40)
SHIFT = (0.1, -0.05)
ROOT3 = math.sqrt(3)


def view(azimuth: Tensor, elevation: Tensor, fov: Tensor, orthographic: bool = False) -> View:
    """A camera in orbit around the origin at 5 meters; its lens angle spans the width."""
    return View(
        position=5 * camera.direction(azimuth, elevation),
        rotation=camera.frame(azimuth, elevation),
        scale=2 * torch.tan(torch.deg2rad(fov) / 2),
        orthographic=orthographic,
        size=SIZE,
        extent=(1.0, SIZE[1] / SIZE[0]),
        shift=SHIFT,
        clip=(0.1, 100.0),
    )


def planar(*vectors: tuple[float, ...]) -> Tensor:
    """Vectors as columns, double precision."""
    return torch.tensor(vectors, dtype=torch.float64).T


ANGLES = (number(30.0), number(20.0), number(50.0))
FRONT = (number(0.0), number(0.0), number(90.0))
"""From -Y; at 5 meters its picture is 10 meters wide, and 6.25 high."""
SHIFTED = (32 - 0.1 * 64, 20 - 0.05 * 64)
"""Where the pivot is: the shift moves the picture to the other side, in units of its width."""


class TestDirection(OperationTests):
    operation = staticmethod(camera.direction)
    inputs = ANGLES[:2]
    shape = (3,)
    wrong = (torch.zeros(2), torch.zeros(2))
    values = (
        (FRONT[:2], [0.0, -1.0, 0.0]),
        ((number(90.0), number(30.0)), [ROOT3 / 2, 0.0, 0.5]),
        ((number(150.0), number(0.0)), [0.5, ROOT3 / 2, 0.0]),
    )


class TestFrame(OperationTests):
    """Right, up and back of a camera in front, at the right, and above."""

    operation = staticmethod(camera.frame)
    inputs = ANGLES[:2]
    shape = (3, 3)
    wrong = (torch.zeros(2), torch.zeros(2))
    values = (
        (FRONT[:2], planar((1, 0, 0), (0, 0, 1), (0, -1, 0))),
        ((number(90.0), number(0.0)), planar((0, 1, 0), (0, 0, 1), (1, 0, 0))),
        ((number(0.0), number(90.0)), planar((1, 0, 0), (0, 1, 0), (0, 0, 1))),
    )


class TestProject(OperationTests):
    operation = staticmethod(lambda *lens: view(*lens[:-1]).project(lens[-1]))
    inputs = (*ANGLES, planar((0.3, 0.2, 0.5), (-0.4, 1.0, 0.1)))
    shape = (2, 2)
    wrong = (*ANGLES, torch.rand(2, 4))
    values = (
        ((*FRONT, planar((0, 0, 0), (0, 7, 0))), [[SHIFTED[0]] * 2, [SHIFTED[1]] * 2]),
        ((*FRONT, planar((5, 0, 0), (10, 5, 0))), [[SHIFTED[0] + 32] * 2, [SHIFTED[1]] * 2]),
        ((*FRONT, planar((0, 0, 2.5))), [[SHIFTED[0]], [SHIFTED[1] - 16]]),
    )


class TestOrthographicProject(OperationTests):
    """Two meters wide, whatever the distance."""

    operation = staticmethod(lambda *lens: view(*lens[:-1], orthographic=True).project(lens[-1]))
    inputs = TestProject.inputs
    shape = (2, 2)
    wrong = TestProject.wrong
    values = (
        ((*FRONT, planar((1, 0, 0), (1, 9, 0))), [[SHIFTED[0] + 32] * 2, [SHIFTED[1]] * 2]),
        ((*FRONT, planar((0, 3, 0.5))), [[SHIFTED[0]], [SHIFTED[1] - 16]]),
    )


class TestRays(OperationTests):
    """Origins and directions."""

    operation = staticmethod(lambda *lens: torch.stack(view(*lens[:-1]).rays(lens[-1])))
    inputs = (*ANGLES, planar((10.5, 3.5), (40.5, 30.5), (63.5, 39.5)))
    shape = (2, 3, 3)
    wrong = (*ANGLES, torch.rand(3, 4))
    values = (
        (
            (*FRONT, planar(SHIFTED, (SHIFTED[0] + 32, SHIFTED[1]))),
            torch.stack((planar((0, -5, 0), (0, -5, 0)), planar((0, 1, 0), (math.sqrt(0.5), math.sqrt(0.5), 0)))),
        ),
    )


class TestSpan(OperationTests):
    """Planes at 0.1 and 100 meters, met straight and at 60 degrees."""

    operation = staticmethod(lambda *lens: torch.stack(view(*lens[:-1]).span(lens[-1])))
    inputs = (*ANGLES, planar((-0.4, 0.8, -0.2)))
    shape = (2, 1)
    wrong = (*ANGLES, torch.rand(2, 4))
    values = (((*FRONT, planar((0, 1, 0), (0.5 * ROOT3, 0.5, 0))), [[0.1, 0.2], [100.0, 200.0]]),)


def test_torch_frame_is_the_schemas() -> None:
    for azimuth, elevation in ((0.0, 0.0), (37.0, -20.0), (200.0, 80.0)):
        ours = camera.frame(torch.tensor(azimuth), torch.tensor(elevation))
        assert torch.allclose(ours, torch.tensor(orbit.frame(azimuth, elevation)), atol=1e-6)


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("fit", ["AUTO", "HORIZONTAL", "VERTICAL"])
def test_projection_inverts_rays(kind: str, fit: str) -> None:
    scene = balls(2, 1, 2)
    lens = dataclasses.replace(scene.camera, type=kind, sensor_fit=fit, shift=SHIFT)
    scene = dataclasses.replace(scene, camera=lens, pixel_aspect=1.3)
    seen = view_of(scene, RenderValues(scene, {}, "cpu"), SIZE)
    pixel = torch.rand((2, 50), generator=torch.Generator().manual_seed(1)) * torch.tensor([[64.0], [40.0]])
    origin, toward = seen.rays(pixel)
    assert torch.allclose(seen.project(origin + 3.0 * toward), pixel, atol=1e-3)
