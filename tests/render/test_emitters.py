# SPDX-License-Identifier: Apache-2.0
"""Glowing surfaces as lamps: as bright as form factors say, differentiable, counted once."""

import math
from dataclasses import replace

import numpy as np
import pytest
import torch
import trimesh

from lab.bench.scenes import balls
from proxy_renderer.render.geometry.camera import view_of
from proxy_renderer.render.lights.emitters import Emitters, clusters_of
from proxy_renderer.render.material.inputs import geometry_of, shading_inputs_of
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene.data import Texture
from proxy_renderer.scene.values import RenderValues

SIZE = (48, 48)
PLACE = np.array([0.0, 0.0, 1.0])
NEAR = 6.0
CPU = torch.device("cpu")
EMISSION = "material/Ball 0/emission"


def scene_with(shape, **values):
    """A black world and a floor, over which a shape hangs whose material is "Ball 0"."""
    scene = balls(2, 0, 1)
    floor = scene.mesh.material == 1
    corners = np.concatenate((shape.vertices[shape.faces], scene.mesh.vertices[scene.mesh.faces[floor]]))
    normals = np.concatenate((np.repeat(shape.face_normals[:, None], 3, 1), scene.mesh.normals[floor]))
    owner = np.repeat([0, 1], [len(shape.faces), int(floor.sum())]).astype(np.int32)
    count = len(corners)
    mesh = replace(
        scene.mesh,
        vertices=corners.reshape(-1, 3).astype(np.float32),
        faces=np.arange(3 * count, dtype=np.int32).reshape(-1, 3),
        normals=normals.astype(np.float32),
        uvs=np.zeros((count, 3, 2), np.float32),
        material=owner,
        object=owner,
    )
    given = {
        "material/Floor/specular": (0.0,),
        "material/Floor/base_color": (0.5, 0.5, 0.5),
        "world/color": (0.0, 0.0, 0.0),
        "material/Ball 0/emission_color": (1.0, 0.5, 0.25),
        "material/Ball 0/base_color": (0.0, 0.0, 0.0),
        "material/Ball 0/specular": (0.0,),
        **values,
    }
    known = {k: replace(i, value=given.get(k, i.value)) for k, i in scene.instances.items()}
    return replace(scene, mesh=mesh, instances=known)


def moved(shape, turn=None):
    if turn is not None:
        shape.apply_transform(trimesh.transformations.rotation_matrix(*turn))
    shape.apply_translation(PLACE)
    return shape


def ball(radius=0.1):
    return moved(trimesh.creation.icosphere(4, radius))


SHAPES = {
    "ball": ball,
    "plate": lambda: moved(
        trimesh.Trimesh([[-0.1, -0.1, 0], [0.1, -0.1, 0], [0.1, 0.1, 0], [-0.1, 0.1, 0]], [[0, 1, 2], [0, 2, 3]]),
        (0.6, (1, 0, 0)),
    ),
    "tube": lambda: moved(trimesh.creation.cylinder(0.03, 1.2, sections=64), (math.pi / 2, (1, 0, 0))),
}


@pytest.mark.parametrize("name", SHAPES)
def test_clusters_light_a_floor_as_the_whole_surface_does(name):
    """Against the sum over many points; backs of closed surfaces do not count."""
    shape = SHAPES[name]()
    clusters = clusters_of(geometry_of(scene_with(shape), CPU), 0, NEAR)
    assert clusters
    points = torch.stack((torch.linspace(-2, 2, 21), torch.linspace(-1, 2, 21), torch.zeros(21)))
    up = torch.tensor([[0.0], [0.0], [1.0]]).expand(3, 21)
    found = sum(power * lamp.irradiance(points, up).irradiance for lamp, power in clusters)
    samples, face = trimesh.sample.sample_surface(shape, 20000, seed=1)
    place, normal = torch.from_numpy(samples).float().T, torch.from_numpy(shape.face_normals[face]).float().T
    offset = place[:, None] - points[:, :, None]
    squared = (offset * offset).sum(0)
    shining = -(normal[:, None] * offset).sum(0) / squared.sqrt()
    shining = shining.clamp_min(0.0) if shape.is_watertight else shining.abs()
    wanted = (shining * offset[2].clamp_min(0.0) / squared**1.5).mean(1) * shape.area
    torch.testing.assert_close(found, wanted, rtol=0.03, atol=0.02 * float(wanted.max()))


def test_a_small_ball_lights_the_floor_by_its_form_factor():
    radius, strength = 0.1, 50.0
    scene = scene_with(ball(radius))
    values = {EMISSION: torch.tensor([strength])}
    with torch.no_grad():
        render = Proxy(scene, SIZE).render(values)
    view = view_of(scene, RenderValues(scene, values, CPU), SIZE)
    y, x = torch.meshgrid(torch.arange(SIZE[1]) + 0.5, torch.arange(SIZE[0]) + 0.5, indexing="ij")
    origin, toward = view.rays(torch.stack((x, y)).flatten(1))
    point = origin + toward * render.depth.flatten()
    offset = torch.from_numpy(PLACE).float()[:, None] - point
    squared = (offset * offset).sum(0)
    irradiance = strength * math.pi * radius**2 * offset[2] / squared**1.5
    floor = (point[2].abs() < 1e-3) & (squared < 6.0) & (render.mask.flatten() == 0)
    assert floor.sum() > 100
    found = render.linear.view(-1, 3)[floor]
    expected = 0.5 / math.pi * irradiance[floor, None] * torch.tensor([1.0, 0.5, 0.25])
    assert (found / expected - 1).abs().mean() < 0.02


def test_the_gradient_of_emission_is_exact():
    """The picture is linear in emission."""
    proxy = Proxy(scene_with(ball()), SIZE)
    strength = torch.tensor([20.0], requires_grad=True)
    weight = torch.rand((*SIZE, 3), generator=torch.Generator().manual_seed(0))
    total = (proxy.render({EMISSION: strength}).linear * weight).sum()
    (slope,) = torch.autograd.grad(total, strength)
    with torch.no_grad():
        more = (proxy.render({EMISSION: strength + 10}).linear * weight).sum()
    assert slope.item() == pytest.approx((more - total).item() / 10, rel=1e-4)


def test_only_what_glows_becomes_a_lamp_and_stays_one():
    scene = scene_with(ball())
    emitters = Emitters(geometry_of(scene, CPU), NEAR)

    def shading_inputs(strength):
        settings = RenderValues(scene, {EMISSION: torch.tensor([strength])}, CPU)
        return [shading_inputs_of(m, settings) for m in scene.materials]

    assert not emitters.notice(shading_inputs(0.0))
    assert not emitters.lamps(shading_inputs(0.0))
    assert emitters.notice(shading_inputs(5.0))
    assert emitters.clusters[0]
    assert not emitters.notice(shading_inputs(0.0))
    assert len(emitters.lamps(shading_inputs(0.0))) == 1


def test_each_of_many_scattered_bulbs_is_a_lamp():
    bulbs = [ball(0.05).apply_translation((x, y, 0.0)) for x in range(-2, 3) for y in range(-2, 3)]
    clusters = clusters_of(geometry_of(scene_with(trimesh.util.concatenate(bulbs)), CPU), 0, NEAR)
    assert len(clusters) >= len(bulbs)
    assert all(float(lamp.size) < 0.06 for lamp, _ in clusters)


def test_a_glowing_wall_stays_with_the_bounced_rays():
    wall = trimesh.Trimesh([[-4, 3, 0], [4, 3, 0], [4, 3, 5], [-4, 3, 5]], [[0, 1, 2], [0, 2, 3]])
    assert not clusters_of(geometry_of(scene_with(wall), CPU), 0, NEAR)


def test_a_parameter_tints_a_computed_glow_and_others_receive_its_mean():
    """The map says where and how it glows, the color of the glow multiplies it."""
    scene = scene_with(ball())
    stripes = Texture(np.float32([[[1.0, 1.0, 1.0], [0.0, 0.0, 0.0]]]))
    material = replace(scene.materials[0], maps={"emission_color": stripes})
    inputs = shading_inputs_of(material, RenderValues(scene, {EMISSION: torch.tensor([2.0])}, CPU))
    assert inputs.emission.tolist() == pytest.approx([1.0, 0.5, 0.25])
    shown = inputs.varied({"emission_color": torch.from_numpy(stripes.image[0]).T})
    torch.testing.assert_close(shown.emission, torch.tensor([[2.0, 0.0], [1.0, 0.0], [0.5, 0.0]]))


def test_a_rough_mirror_shows_a_lamp_without_grain():
    """Pictures of two seeds are alike: a small bright lamp is found by enough rays."""
    lamp = moved(trimesh.creation.box((1.0, 0.05, 0.8)))
    mirror = {"material/Floor/metallic": (1.0,), "material/Floor/roughness": (0.4,), EMISSION: (5.0,)}
    with torch.no_grad():
        scene = scene_with(lamp, **mirror)
        first, second = (Proxy(scene, (64, 64), seed=seed).render({}) for seed in (0, 1))
    floor = (first.mask == 0) & (first.linear.mean(-1) > 1e-3)
    mean = first.linear[floor].mean()
    assert (first.linear - second.linear)[floor].square().mean().sqrt() < 0.2 * mean
