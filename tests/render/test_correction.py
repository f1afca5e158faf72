# SPDX-License-Identifier: Apache-2.0
"""A proxy that is corrected by a picture of another renderer, for which a proxy of a changed scene stands."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import torch
from torch import Tensor

from lab.bench.scenes import balls
from proxy_renderer.render.cycles import REST, CyclesPicture, blur, look_up
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import SceneData
from proxy_renderer.schema import VibeError

SIZE = (64, 64)
SCENE = balls(3, 2, subdivisions=3)
DIFFERENT = {"material/Ball 0/base_color": (0.3, 0.7, 0.2), "material/Floor/roughness": (0.2,)}
DIM = {"light/Lamp 0/power": 0.0, "light/Lamp 1/power": 0.0, "world/strength": 0.0}
OWNERS = {"light/Lamp 0": "light/Lamp 0/power", "light/Lamp 1": "light/Lamp 1/power", "world": "world/strength"}


def other_renderer() -> SceneData:
    """The scene as the other renderer sees it: some values are not what the proxy takes them for."""
    changed = {k: dataclasses.replace(SCENE.instances[k], value=v) for k, v in DIFFERENT.items()}
    return dataclasses.replace(SCENE, instances={**SCENE.instances, **changed})


@pytest.fixture(scope="module")
def truth() -> Proxy:
    return Proxy(other_renderer(), SIZE)


@pytest.fixture
def proxy() -> Proxy:
    return Proxy(SCENE, SIZE)


def tensors(values: dict[str, float | tuple[float, ...]]) -> dict[str, Tensor]:
    return {k: torch.tensor(v if isinstance(v, tuple) else (v,)) for k, v in values.items()}


def picture_of(truth: Proxy) -> CyclesPicture:
    """What the other renderer makes of the artist's values, light by light."""
    with torch.no_grad():
        whole = truth.render({}).linear
        parts = {}
        for owner, key in OWNERS.items():
            only = {k: v for k, v in DIM.items() if k != key}
            parts[owner] = truth.render(tensors(only)).linear
    return CyclesPicture(whole, parts, torch.zeros_like(whole))


def render(proxy: Proxy, **values: float | tuple[float, ...]) -> Tensor:
    with torch.no_grad():
        return proxy.render(tensors(values)).linear


def test_it_is_the_picture_at_the_anchor(truth: Proxy, proxy: Proxy) -> None:
    picture = picture_of(truth)
    assert (render(proxy) - picture.whole).abs().max() > 0.05
    proxy.anchor({}, picture)
    torch.testing.assert_close(render(proxy), picture.whole, atol=1e-5, rtol=1e-4)
    proxy.correction = None
    assert (render(proxy) - picture.whole).abs().max() > 0.05


@pytest.mark.parametrize(
    "values",
    [
        {"light/Lamp 0/power": 700.0},
        {"light/Lamp 1/power": 0.0},
        {"light/Lamp 0/color": (1.0, 0.3, 0.1), "light/Lamp 1/temperature": 3000.0},
        {"world/strength": 3.0, "world/color": (0.1, 0.15, 0.2)},
    ],
    ids=str,
)
def test_it_is_right_while_only_light_changes(truth: Proxy, proxy: Proxy, values) -> None:
    """To a percent of the mean: the shares of the lights are smoothed a little."""
    proxy.anchor({}, picture_of(truth))
    wanted = render(truth, **values)
    error = (render(proxy, **values) - wanted).abs().mean() / wanted.mean()
    proxy.correction = None
    before = (render(proxy, **values) - wanted).abs().mean() / wanted.mean()
    assert error < 0.01
    assert error < before / 10


def test_its_gradient_is_the_proxys_times_the_ratio(proxy: Proxy) -> None:
    """A renderer that is brighter by a fifth everywhere."""
    keys = ("material/Ball 0/base_color", "material/Floor/roughness", "light/Lamp 0/azimuth")
    values = {k: torch.tensor(SCENE.instances[k].value, requires_grad=True) for k in keys}

    def slopes() -> tuple[Tensor, ...]:
        ramp = torch.linspace(0, 1, SIZE[0])[None, :, None]
        return torch.autograd.grad((proxy.render(values).linear * ramp).mean(), list(values.values()))

    plain = slopes()
    whole = render(proxy)
    parts = {o: 1.2 * render(proxy, **{k: v for k, v in DIM.items() if k != key}) for o, key in OWNERS.items()}
    proxy.anchor({}, CyclesPicture(1.2 * whole, parts, torch.zeros_like(whole)))
    for before, after in zip(plain, slopes(), strict=True):
        torch.testing.assert_close(after, 1.2 * before, rtol=0.03, atol=1e-6)


def test_the_gradient_of_a_power_is_cycles_own(truth: Proxy, proxy: Proxy) -> None:
    picture = picture_of(truth)
    proxy.anchor({}, picture)
    power = torch.tensor(SCENE.instances["light/Lamp 0/power"].value, requires_grad=True)
    proxy.render({"light/Lamp 0/power": power}).linear.mean().backward()
    assert power.grad is not None
    assert power.grad.item() == pytest.approx((picture.parts["light/Lamp 0"].mean() / power.detach()).item(), rel=0.01)


@pytest.mark.parametrize("brightness", [0.0, 1e-8, 1e4])
def test_extreme_pictures_leave_no_holes(proxy: Proxy, brightness: float) -> None:
    whole = torch.full((*SIZE[::-1], 3), brightness)
    proxy.anchor({}, CyclesPicture(whole, {"world": whole * 0.5}, whole * 0.5))
    torch.testing.assert_close(render(proxy), whole, atol=1e-5, rtol=1e-3)
    values = tensors({"light/Lamp 0/power": 5.0, "world/strength": 0.0, "material/Floor/base_color": (0.9, 0.0, 0.0)})
    values = {k: v.requires_grad_() for k, v in values.items()}
    out = proxy.render(values).linear
    assert (out >= 0).all()
    assert torch.isfinite(out).all()
    assert all(torch.isfinite(g).all() for g in torch.autograd.grad(out.sum(), list(values.values())))


def test_a_light_that_was_off_comes_on_as_the_proxy_has_it(proxy: Proxy) -> None:
    off = {"light/Lamp 0/power": 0.0}
    dark = render(proxy, **off)
    proxy.anchor(tensors(off), CyclesPicture(dark, {"light/Lamp 0": torch.zeros_like(dark)}, dark))
    on = render(proxy, **{"light/Lamp 0/power": 300.0})
    proxy.correction = None
    torch.testing.assert_close(on, render(proxy, **{"light/Lamp 0/power": 300.0}), rtol=0.02, atol=1e-4)


def test_another_size_is_refused(proxy: Proxy) -> None:
    small = torch.ones((32, 32, 3))
    with pytest.raises(VibeError, match="pixels"):
        proxy.anchor({}, CyclesPicture(small, {}, small))


def test_a_larger_picture_has_no_halos(truth: Proxy, proxy: Proxy) -> None:
    """Balls that Cycles shows brighter do not lighten the floor behind them."""
    proxy.anchor({}, picture_of(truth))
    large, wanted = (Proxy(s, (128, 128)) for s in (SCENE, other_renderer()))
    before = (render(large) - render(wanted)).abs()
    large.correction = proxy.correction
    after = (render(large) - render(wanted)).abs()
    assert after.mean() < 0.25 * before.mean()
    same = before.amax(-1) < 1e-3  # where the renderers agree, away from what they disagree on
    assert same.float().mean() > 0.1
    assert after[same].mean() < 2e-3
    assert after[same].quantile(0.99) < 0.02


@pytest.mark.parametrize("values", [{"roughness": 0.02}, {"metallic": 1.0, "roughness": 0.02}], ids=str)
def test_a_larger_picture_may_take_other_samples_than_the_anchors_values_would(
    truth: Proxy, proxy: Proxy, values: dict[str, float]
) -> None:
    """Smooth surfaces are sampled more finely, and metals are traced as mirrors."""
    larger = Proxy(SCENE, (96, 96), fine=True)
    larger.correction = proxy.anchor({}, picture_of(truth))
    first = render(larger)
    changed = render(larger, **{f"material/Ball 1/{name}": value for name, value in values.items()})
    assert torch.isfinite(changed).all()
    assert (changed - first).abs().max() > 0.01
    torch.testing.assert_close(render(larger), first, atol=1e-5, rtol=1e-4)


def test_a_camera_that_moves_takes_the_correction_along(truth: Proxy, proxy: Proxy) -> None:
    moved = {"camera/azimuth": 8.0, "camera/distance": 7.0}
    wanted = render(truth, **moved)
    before = (render(proxy, **moved) - wanted).abs().mean()
    proxy.anchor({}, picture_of(truth))
    assert (render(proxy, **moved) - wanted).abs().mean() < 0.5 * before
    behind = {"camera/azimuth": 180.0}
    corrected = render(proxy, **behind)
    proxy.correction = None
    assert torch.isfinite(corrected).all()
    assert (corrected - render(proxy, **behind)).abs().mean() < 0.3 * corrected.mean()


def test_smoothing_and_looking_up_stop_at_outlines() -> None:
    names = torch.zeros((8, 8), dtype=torch.int64)
    names[:, 4:] = 1
    field = torch.where(names == 0, 1.0, 5.0).flatten()[None]
    torch.testing.assert_close(blur(field, names), field)
    place = torch.tensor([[3.9, 4.1, 0.0, 100.0], [4.0, 4.0, 0.0, 4.0]])
    found = look_up(field, names, place, torch.tensor([0, 1, 0, 0]), torch.tensor([9.0]))
    torch.testing.assert_close(found, torch.tensor([[1.0, 5.0, 1.0, 9.0]]))


def test_what_belongs_to_a_highlight_stays_with_it() -> None:
    bright = torch.zeros((8, 8))
    bright[:, 4:] = 3.0
    field = torch.where(bright > 0, 5.0, 1.0).flatten()[None]
    place = torch.tensor([[3.9, 3.9, 3.9], [4.0, 4.0, 4.0]])
    stops = bright.flatten(), torch.tensor([0.0, 3.0, -9.0])
    guide = torch.zeros((8, 8), dtype=torch.int64)
    found = look_up(field, guide, place, torch.zeros(3, dtype=torch.int64), torch.tensor([9.0]), stops)
    torch.testing.assert_close(found, torch.tensor([[1.0, 5.0, 9.0]]))


def write(path: Path, layers: dict[str, np.ndarray], apart: bool) -> Path:
    """A multilayer EXR as Blender 4 (one part) or 5 (one part per layer) writes it."""
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    named = {f"ViewLayer.{name}": p for name, p in layers.items()}
    sets = [{name: p} for name, p in named.items()] if apart else [named]
    parts = [OpenEXR.Part(dict(header), dict(s), f"part {i}") for i, s in enumerate(sets)]
    OpenEXR.File(parts).write(str(path))
    return path


@pytest.mark.parametrize("apart", [False, True])
def test_files_of_both_blenders_are_read(tmp_path: Path, apart: bool) -> None:
    shape = (4, 6, 3)
    rng = np.random.default_rng(0)
    whole, key, world = (rng.random(shape, np.float32) for _ in range(3))
    noisy = key + world + 0.25
    noisy[0, 0] = np.nan
    layers = {"Combined": whole, "Noisy Image": noisy, "Combined_Vibe 0": key, "Combined_Vibe 1": world}
    path = write(tmp_path / "a.exr", layers, apart)
    groups = {"Vibe 0": "light/Key", "Vibe 1": "world"}
    found = CyclesPicture.load(path, groups)
    assert found.size == (6, 4)
    np.testing.assert_allclose(found.whole.numpy(), whole, atol=1e-6)
    np.testing.assert_allclose(found.parts["world"].numpy(), world, atol=1e-6)
    assert torch.isfinite(found.rest).all()
    np.testing.assert_allclose(found.rest[1:].numpy(), 0.25, atol=1e-5)
    assert found.denoised
    del layers["Noisy Image"]
    plain = CyclesPicture.load(write(path, layers, apart), groups)
    assert not plain.denoised
    np.testing.assert_allclose(plain.whole.numpy(), whole, atol=1e-6)


def test_without_a_denoiser_the_noise_does_not_reach_the_picture(truth: Proxy, proxy: Proxy) -> None:
    clean = picture_of(truth)
    noise = 0.3 * torch.randn(clean.whole.shape, generator=torch.Generator().manual_seed(1))
    whole = (clean.whole * (1 + noise)).clamp_min(0)
    proxy.anchor({}, dataclasses.replace(clean, whole=whole, denoised=False))
    inside = render(proxy)
    error, noisy = (inside - clean.whole).abs().mean(), (whole - clean.whole).abs().mean()
    assert error < 0.45 * noisy


@pytest.mark.parametrize("content", [b"", b"not an EXR at all"])
def test_a_broken_file_is_an_error(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.exr"
    path.write_bytes(content)
    with pytest.raises(VibeError, match="cannot be read"):
        CyclesPicture.load(path, {})


def test_what_is_not_there_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(VibeError, match="cannot be read"):
        CyclesPicture.load(tmp_path / "none.exr", {})
    path = write(tmp_path / "a.exr", {"Combined": np.zeros((2, 2, 3), np.float32)}, False)
    with pytest.raises(VibeError, match="no layer"):
        CyclesPicture.load(path, {"Vibe 0": "world"})


def test_the_rest_is_an_owner_too(truth: Proxy, proxy: Proxy) -> None:
    assert proxy.anchor({}, picture_of(truth)).owners == (*OWNERS, REST)


@pytest.mark.parametrize(
    ("values", "layered"),
    [
        ({"light/Lamp 0/power": 700.0}, True),
        ({"light/Lamp 0/color": (1.0, 0.3, 0.1), "light/Lamp 1/temperature": 3000.0}, True),
        ({"world/strength": 3.0, "world/color": (0.1, 0.15, 0.2), "film/exposure": 1.0}, True),
        ({"light/Lamp 1/power": 0.0, "light/Lamp 0/size": SCENE.value("light/Lamp 0/size")}, True),
        ({"light/Lamp 0/power": 1e6}, False),
        ({"light/Lamp 0/power": 700.0, "light/Lamp 0/size": 0.3}, False),
        ({"material/Floor/roughness": 0.2}, False),
    ],
    ids=str,
)
def test_layers_of_the_anchor_add_up_to_what_would_be_drawn(truth: Proxy, proxy: Proxy, values, layered) -> None:
    proxy.anchor({}, picture_of(truth))
    with torch.no_grad():
        assert (proxy.layered(tensors(values)) is not None) == layered
    quick = render(proxy, **values)
    proxy._anchored = proxy._undeveloped = None
    torch.testing.assert_close(quick, render(proxy, **values), atol=1e-5, rtol=1e-4)


def test_gradients_pass_no_layers(truth: Proxy, proxy: Proxy) -> None:
    proxy.anchor({}, picture_of(truth))
    power = torch.tensor([700.0], requires_grad=True)
    assert proxy.layered({"light/Lamp 0/power": power}) is None
