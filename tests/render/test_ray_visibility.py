# SPDX-License-Identifier: Apache-2.0
"""What rays meet: each triangle is in one tree, built once; objects hide from the rays that pass them."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch

from lab.bench.scenes import balls
from proxy_renderer.render.geometry import visibility
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import MeshObject, SceneData

SIZE = (32, 32)
GLOW = {"material/Ball 0/emission": 20.0, "material/Ball 1/transmission": 1.0, "world/color": 0.0}


def _scene(*hidden: str) -> SceneData:
    """Two balls over a floor, the first of which glows and the second of which is of glass."""
    scene = balls(3, 1, 2)
    values = {k: replace(i, value=(GLOW[k],) * len(i.value)) if k in GLOW else i for k, i in scene.instances.items()}
    first = MeshObject("Ball 0", True, hidden)
    return replace(scene, instances=values, objects=(first, *scene.objects[1:]))


def test_every_triangle_is_built_into_one_tree_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also of glass and of lamps, and by all proxies of a scene: trees cost more than rays."""
    built: list[int] = []
    original = visibility.TriangleMesh

    def spy(scene: object, vertices: object, faces: torch.Tensor) -> object:
        built.append(len(faces))
        return original(scene, vertices, faces)

    monkeypatch.setattr(visibility, "TriangleMesh", spy)
    scene = _scene()
    first, second = Proxy(scene, SIZE), Proxy(scene, (16, 16))
    for proxy in (first, second):
        with torch.no_grad():
            proxy.render({})
    assert sum(built) == len(scene.mesh.faces), built


def test_threads_share_rays_and_find_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(torch, "get_num_threads", lambda: 1)
    alone = Proxy(_scene(), SIZE).render({}).linear
    monkeypatch.setattr(torch, "get_num_threads", lambda: 3)
    monkeypatch.setattr(visibility, "_SHARE", 10)
    assert torch.equal(Proxy(_scene(), SIZE).render({}).linear, alone)


def test_a_lamp_hidden_from_the_camera_still_lights_the_floor() -> None:
    seen, hidden = Proxy(_scene(), SIZE), Proxy(_scene("camera"), SIZE)
    with torch.no_grad():
        before, after = seen.render({}), hidden.render({})
    floor = (before.mask == 0) & (after.mask == 0)
    assert float(after.mask.sum()) < 0.7 * float(before.mask.sum())
    lit = before.linear[floor].mean()
    assert float((after.linear[floor].mean() / lit - 1).abs()) < 0.05


def test_what_hides_from_shadow_rays_casts_no_shadow() -> None:
    off = {"material/Ball 0/emission": torch.zeros(1)}
    with torch.no_grad():
        shaded, bright = (Proxy(_scene(*h), SIZE).render(off).linear for h in ((), ("shadow",)))
    assert float((bright - shaded).amax()) > 0.1 * float(shaded.mean())
    assert float((bright - shaded).mean()) > 0.0
