# SPDX-License-Identifier: Apache-2.0
"""Blurred reflections beside very many rays: neither grain nor smeared edges."""

import pytest
import torch
import trimesh
from marks import few_of

from proxy_renderer.render.geometry.visibility import sphere_points
from proxy_renderer.render.lights.environment import GLOSSY
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.render.surface.surfaces import direct_lights_of, table_of
from proxy_renderer.render.transport.glow import BLURS, LobeRays

from .test_emitters import moved, scene_with
from .test_glow import panel

RAYS = 256
ERRORS = [*zip(BLURS, (0.02, 0.01, 0.0067), strict=True)]
"""Roughness, and the most that its reflections may be off."""
GLOW = {"material/Ball 0/emission": (5.0,)}


def beside_many_rays(scene, roughness):
    """Indirect light, which samples are the floor's, and the share (n,) of many rays of their lobes that hit anything."""
    proxy = Proxy(scene, (192, 192))
    with torch.no_grad():
        frame = proxy._frame({})
        direct_lights_of(frame)
        gathered = proxy._gather(frame, table_of(frame))
        cache, geometry = frame.cache, proxy.geometry
        chosen = slice(*next((start, stop) for m, start, stop in cache.samples.slices if m == 1))
        points = frame.view_samples.surface.pick(chosen)
        lobes = LobeRays.of(points, cache.samples.toward[:, chosen])
        count = len(points.material)
        uv = sphere_points(RAYS, count, torch.Generator().manual_seed(1))
        hits = geometry.first_hits(
            geometry.lifted(points).repeat_interleave(RAYS, 1), lobes.reflections(uv, roughness**2), "glossy"
        )
        return gathered, chosen, hits.hit.view(count, RAYS).float().mean(1)


@pytest.mark.parametrize(("roughness", "error"), few_of(ERRORS, ERRORS[:1]))
def test_what_glows_is_mirrored_with_its_edges(roughness, error):
    gathered, chosen, hit = beside_many_rays(scene_with(panel(2.0, 1.5, 2.0), **GLOW), roughness)
    share = gathered.glow[1 + BLURS.index(roughness)][0, chosen] / 5
    assert (share - hit).square().mean().sqrt() < error


def test_the_world_in_a_rough_floor_has_no_grain():
    gathered, chosen, hit = beside_many_rays(scene_with(moved(trimesh.creation.box((1.0, 1.0, 1.0)))), GLOSSY)
    assert (gathered.open_glossy[chosen] - (1 - hit)).square().mean().sqrt() < 0.027
