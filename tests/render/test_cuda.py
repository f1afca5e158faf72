# SPDX-License-Identifier: Apache-2.0
"""On a CUDA card pictures and gradients are those of the processor."""

import pytest
import torch
from tiny_job import write_job

from lab.bench.scenes import outdoors
from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene

pytestmark = pytest.mark.skipif(not torch.cuda.is_available(), reason="there is no CUDA card")

SIZE = (64, 48)


def picture_and_slopes(scene, device, anchored=False):
    """Display values (H, W, 3) on the processor, and their mean's gradient by all parameters, one after the other."""
    proxy = Proxy(scene, SIZE, device)
    if anchored:
        whole = torch.linspace(0.1, 0.9, SIZE[0] * SIZE[1] * 3).view(SIZE[1], SIZE[0], 3)
        proxy.anchor({}, CyclesPicture(whole, {"world": 0.5 * whole}, 0.5 * whole))
    values = {key: torch.tensor(i.value, requires_grad=True) for key, i in scene.instances.items()}
    picture = proxy.render(values).display
    weights = torch.linspace(0.0, 1.0, picture.numel(), device=picture.device)
    (picture.flatten() * weights).sum().backward()
    slopes = [torch.zeros_like(v) if v.grad is None else v.grad for v in values.values()]
    return picture.detach().cpu(), torch.cat(slopes)


@pytest.mark.parametrize("anchored", [False, True])
@pytest.mark.parametrize("name", ["tiny", "outdoors"])
def test_pictures_and_gradients_agree(tmp_path, name, anchored):
    scene = load_scene(write_job(tmp_path)) if name == "tiny" else outdoors(8, 4)
    picture, slopes = picture_and_slopes(scene, "cpu", anchored)
    ours, our_slopes = picture_and_slopes(scene, "cuda", anchored)
    # A card rounds the starts of rays otherwise: one in thousands passes an edge that it met on the processor.
    off = (ours - picture).abs()
    assert off.max() < 0.02
    assert (off > 0.005).float().mean() < 1e-3
    assert torch.cosine_similarity(our_slopes, slopes, 0) > 0.999
