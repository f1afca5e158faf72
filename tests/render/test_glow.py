# SPDX-License-Identifier: Apache-2.0
"""What glows, as surfaces see it: the right share of every lobe, and little noise."""

import math

import pytest
import torch
import trimesh

from proxy_renderer.render.geometry.vectors import unit
from proxy_renderer.render.geometry.visibility import RayGeometry, Surface, sphere_points
from proxy_renderer.render.material.inputs import geometry_of
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.render.transport.glow import BLURS, LobeRays, glow_of

from .test_emitters import CPU, scene_with

COPIES = 64
RAYS = 8192


def panel(width: float, height: float, near: float) -> trimesh.Trimesh:
    """A glowing wall with a gap below it."""
    w = width / 2
    corners = [[-w, near, 0.4], [w, near, 0.4], [w, near, 0.4 + height], [-w, near, 0.4 + height]]
    return trimesh.Trimesh(corners, [[0, 1, 2], [0, 2, 3]])


PANELS = {"softbox": panel(2.0, 1.5, 2.0), "window at the wall": panel(1.0, 1.0, 0.3), "slit": panel(0.05, 1.0, 3.0)}


def floor(place: float) -> tuple[Surface, torch.Tensor]:
    """Copies of one point of the floor, and the direction from which a camera sees it."""
    up = torch.tensor([0.0, 0.0, 1.0])[:, None].expand(3, COPIES).contiguous()
    position = torch.tensor([0.1, place, 0.0])[:, None].expand(3, COPIES).contiguous()
    surface = Surface(position, up, up, torch.zeros(2, COPIES), *torch.ones((2, COPIES), dtype=torch.int64))
    arrived = unit(torch.tensor([0.0, 3.0, -1.0])[:, None]).expand(3, COPIES).contiguous()
    return surface, arrived


def searched(name: str) -> tuple[list[torch.Tensor], RayGeometry, LobeRays]:
    geometry = geometry_of(scene_with(PANELS[name]), CPU)
    lobes, turn = LobeRays.of(*floor(0.0)), torch.arange(COPIES)
    glow = glow_of(geometry, lobes, turn, turn, {0: ()}, torch.Generator().manual_seed(0))
    return glow, geometry, lobes


def found_by_chance(geometry: RayGeometry, lobes: LobeRays, alpha: float | None) -> float:
    """Share of very many rays of a lobe, or of the hemisphere, that end on the panel."""
    uv = sphere_points(RAYS, COPIES, torch.Generator().manual_seed(1))
    toward = lobes.hemisphere(uv) if alpha is None else lobes.reflections(uv, alpha)
    hits = geometry.first_hits(geometry.lifted(lobes.points).repeat_interleave(RAYS, 1), toward, "diffuse")
    return float((hits.hit & (geometry.material[hits.triangle.clamp_min(0)] == 0)).float().mean())


@pytest.mark.parametrize("name", PANELS)
def test_shares_are_those_of_very_many_rays_with_little_noise(name):
    glow, geometry, lobes = searched(name)
    for share, alpha in zip(glow, (None, *(r * r for r in BLURS)), strict=True):
        wanted = found_by_chance(geometry, lobes, alpha)
        assert share[:, 0].mean().item() == pytest.approx(wanted, rel=0.06, abs=0.006)
        # As many rays by chance alone would be off by the root of the share times the rest over their number.
        by_chance = math.sqrt(wanted * (1 - wanted) / 48)
        assert share[:, 0].std().item() < max(0.4 * by_chance, 0.07 * wanted)
        assert share[:, 1].abs().max() == 0


def test_densities_of_lobes_add_up_to_one():
    """Over the whole sphere; a narrow lobe as well as a wide one, seen from a flat angle."""
    surface, arrived = floor(0.0)
    lobes = LobeRays.of(surface, arrived)
    z, angle = torch.meshgrid(
        (torch.arange(1600) + 0.5) / 800 - 1, (torch.arange(1600) + 0.5) / 1600 * 2 * math.pi, indexing="ij"
    )
    flat = (1 - z * z).sqrt()
    sphere = torch.stack((flat * angle.cos(), flat * angle.sin(), z)).flatten(1)
    one = LobeRays(surface.pick(slice(0, 1)), arrived[:, :1], lobes.cosine[:1])
    for roughness in (0.2, 0.4, 0.7):
        total = one.reflections_density(sphere, roughness**2).mean() * 4 * math.pi
        assert total.item() == pytest.approx(1.0, abs=0.03)


def test_a_rough_floor_mirrors_a_softbox_without_an_edge():
    """Half as rough as glossy: across the softbox's edge the picture falls off over several pixels."""
    floor_ = {"material/Floor/metallic": (1.0,), "material/Floor/roughness": (0.2,)}
    scene = scene_with(panel(2.0, 1.5, 2.0), **floor_, **{"material/Ball 0/emission": (5.0,)})
    with torch.no_grad():
        render = Proxy(scene, (96, 96)).render({})
    shown = render.linear.mean(-1) * (render.mask == 0)
    steps = (shown[1:] - shown[:-1]).abs()[(render.mask[1:] == 0) & (render.mask[:-1] == 0)]
    assert shown.max() > 1.0
    assert steps.max() < 0.35 * shown.max()
