# SPDX-License-Identifier: Apache-2.0
"""A fast batched shader with the looks of the proxy: the same G-buffers under thousands of looks.

It is a picture maker, not a reference: what matters is that every word of the captions can be seen.
All views have leading dimensions (G, 1), all looks (G, K): K looks of each of G views.
"""

import functools
from collections.abc import Callable

import torch
from torch import Tensor

from lab.train.pictures.bank import FAR, STAGE, SUBJECT
from proxy_renderer.color.constants import LUMINANCE_WEIGHTS
from proxy_renderer.color.tensors import srgb_from_linear

Buffers = dict[str, Tensor]
_SHARPEST = 0.01
"""Blur of the sharpest reflection, in radians: less cannot be seen in so small a picture."""
Shade = Callable[[Buffers, Buffers, bool], Tensor]


def shade(view: Buffers, look: dict[str, Tensor], agx: bool) -> Tensor:
    """Pictures (G, K, 4, H, W) in 0..1: display values, and how bright the gleam is: its share of the light and of a middle gray.

    Args:
        view: kind, depth, occlusion, mirror (G, 1, H, W); normal (G, 1, 3, H, W); camera (G, 1, 3, 3),
            tangent (G, 1); light (G, K, 3) towards the key light; shadow (G, K, H, W) what reaches of it.
        look: From `looks.parameters`, (G, K, ...).
        agx: Whether the view transform is AgX (approximated) rather than Standard.
    """
    rays = _rays(view)
    subject = (view["kind"] == SUBJECT)[:, :, None].float()
    stage = (view["kind"] == STAGE)[:, :, None].float()
    depth = view["depth"][:, :, None].clamp_max(FAR)
    reach = 1 / (1 + _scalar(look["falloff"]) * (depth - 1).clamp_min(0) ** 2)  # lamps are near the subject
    body, gleam = _surface(view, look, rays, subject, stage)
    color = (body + gleam) * (subject + stage * reach)
    up = rays[:, :, 2:3]
    color = color + _vector(look["world"]) * (1 + _scalar(look["gradient"]) * up) * (1 - subject - stage)
    clear = torch.exp(-_scalar(look["fog"]) * depth)
    color = color * clear + _vector(look["fog_color"]) * (1 - clear)
    share = _luminance(gleam) / (_luminance(body + gleam) + 0.18 / _scalar(look["exposure"]))
    return torch.cat([view_transform(_grade(color, look), agx), share], 2)


@functools.cache
def fused() -> Shade:
    """`shade` as one loop over the pixels, three times as fast; as it is where there is no C++ compiler."""
    torch._dynamo.config.suppress_errors = True
    return torch.compile(shade, dynamic=False)


def _axis(size: int, device: torch.device) -> Tensor:
    """Pixel centers along one axis, in -1..1."""
    return (torch.arange(size, device=device) + 0.5) * 2 / size - 1


def _rays(view: Buffers) -> Tensor:
    axis = _axis(view["kind"].shape[-1], view["kind"].device)
    x = axis[None, None, None, :] * view["tangent"][..., None, None]
    y = -axis[None, None, :, None] * view["tangent"][..., None, None]
    local = torch.stack(torch.broadcast_tensors(x, y, x.new_tensor(-1.0)), 2)
    return _unit(torch.einsum("gkij,gkjhw->gkihw", view["camera"], local))


def _surface(
    view: Buffers, look: dict[str, Tensor], rays: Tensor, subject: Tensor, stage: Tensor
) -> tuple[Tensor, Tensor]:
    """Diffuse light; the GGX highlight of the key light, and mirrored surroundings with two light panels."""
    normal, shadow, free = view["normal"], view["shadow"][:, :, None], view["occlusion"][:, :, None]
    key, soft = _vector(look["key"]), _scalar(look["soft"])
    towards = _vector(view["light"])
    facing = (-(normal * rays).sum(2, keepdim=True)).clamp(0.02, 1)
    lit = (((normal * towards).sum(2, keepdim=True) + 0.25 * soft) / (1 + 0.25 * soft)).clamp_min(0) * shadow

    albedo = torch.lerp(_vector(look["surroundings"]), _vector(look["subject"]), subject)
    metal = _scalar(look["metal"]) * subject
    ambient = _vector(look["ambient"]) * free * (0.6 + 0.4 * normal[:, :, 2:3])
    base = albedo * (key * lit + ambient + _scalar(look["fill"]) * facing)
    diffuse = base * (1 - metal) + albedo * stage * _scalar(look["backdrop"])

    rough = torch.lerp(subject.new_tensor(0.75), _scalar(look["roughness"]), subject)
    f0 = torch.lerp(_scalar(look["specular"]).expand_as(albedo), albedo, metal)
    half = _unit(towards - rays)
    nh, vh = ((normal * half).sum(2, keepdim=True).clamp(0, 1), (-(rays * half).sum(2, keepdim=True)).clamp(0.1, 1))
    alpha2 = (rough**2 + 0.015 + 0.05 * soft) ** 2
    lobe = alpha2 / (nh**2 * (alpha2 - 1) + 1) ** 2 / (4 * vh**2)
    highlight = (f0 + (1 - f0) * (1 - vh) ** 5) * (lobe * lit).clamp_max(30) * key

    mirror = rays + 2 * facing * normal
    fresnel = f0 + ((1 - rough).clamp_min(0) * (1 - f0)).clamp_min(0) * (1 - facing) ** 5
    mirrored = _mirrored(view, look, mirror, rough) * (1 - 0.75 * view["mirror"][:, :, None]) * (0.3 + 0.7 * free)
    return diffuse, subject * (highlight + fresnel * mirrored)


def _mirrored(view: Buffers, look: dict[str, Tensor], way: Tensor, rough: Tensor) -> Tensor:
    """The light along a mirror ray: world, ground and two rectangular light panels, blurred by roughness.

    An edge seen in GGX of width α = roughness² rises over about 2.7 α to either side (the lobe's half vectors, projected
    on one axis, are distributed like x / √(α² + x²)); a logistic edge of scale 1.2 α comes closest.
    """
    up = way[:, :, 2:3]
    blur = _SHARPEST + 1.2 * rough**2
    has_ground = (view["kind"] == STAGE).flatten(2).any(2).float()[..., None, None, None]
    world = _vector(look["world"]) * (1 + _scalar(look["gradient"]) * up) + 0.5 * _vector(look["ambient"])
    ground = _vector(look["surroundings"]) * (0.45 * _vector(look["key"]) + _vector(look["ambient"]))
    total = torch.lerp(world, ground, torch.sigmoid(-up / blur) * has_ground)
    for k in range(2):
        turn = look["panel_turn"][..., k]
        lx, ly, lz = view["light"].unbind(-1)
        x, y = lx * turn.cos() - ly * turn.sin(), lx * turn.sin() + ly * turn.cos()
        center = torch.nn.functional.normalize(torch.stack([x, y, lz * 0.5 + 0.25], -1), dim=-1)
        side = torch.nn.functional.normalize(torch.stack([-center[..., 1], center[..., 0], 0 * x], -1), dim=-1)
        ahead = (way * _vector(center)).sum(2, keepdim=True)
        across = (way * _vector(side)).sum(2, keepdim=True) / ahead.clamp_min(0.05)
        high = (way * _vector(torch.linalg.cross(center, side))).sum(2, keepdim=True) / ahead.clamp_min(0.05)
        size = _scalar(look["panel_size"][..., k])
        inside = blurred(across, size, blur) * blurred(high, 0.6 * size, blur)
        total = total + _scalar(look["panels"][..., k]) * _vector(look["key"]) * inside * (ahead > 0.05)
    return total


def blurred(at: Tensor, half: Tensor, blur: Tensor) -> Tensor:
    """A bright strip, seen through a blur that keeps its flux.

    Args:
        at: Distance from the strip's middle.
        blur: The blur's width, in the same unit; above 0.

    Returns:
        Brightness, 1 in the middle of a strip without blur.
    """
    return torch.sigmoid((half - at.abs()) / blur) * half / (blur * torch.nn.functional.softplus(half / blur))


def _grade(color: Tensor, look: dict[str, Tensor]) -> Tensor:
    """Exposure, contrast about 0.18, saturation and vignette, in the order of the Vibe Grade."""
    color = (color * _scalar(look["exposure"])).clamp(1e-5, 60)
    contrast = _scalar(look["contrast"])
    color = torch.exp2(torch.log2(color / 0.18) * contrast) * 0.18
    color = torch.lerp(_luminance(color), color, _scalar(look["saturation"])).clamp_min(0)
    axis = _axis(color.shape[-1], color.device)
    radius = torch.sqrt((axis[:, None] ** 2 + axis[None, :] ** 2) / 2)
    t = ((radius - 0.3) / 0.7).clamp(0, 1)
    return color * (1 - _scalar(look["vignette"]) * t**2 * (3 - 2 * t))


_AGX_IN = torch.tensor(
    [
        [0.842479062, 0.0784335999, 0.0792237451],
        [0.0423282422, 0.878468636, 0.0791661274],
        [0.0423756549, 0.0784336, 0.879142973],
    ]
)
_AGX_OUT = torch.tensor(
    [
        [1.19687900, -0.0980208811, -0.0990297440],
        [-0.0528968517, 1.15190312, -0.0989611768],
        [-0.0529716355, -0.0980434501, 1.15107367],
    ]
)


def view_transform(color: Tensor, agx: bool) -> Tensor:
    """Linear light to display values.

    Args:
        color: (..., 3, H, W), linear Rec.709.
        agx: Whether by AgX, in Benjamin Wrensch's polynomial fit; else by sRGB's curve.

    Returns:
        (..., 3, H, W) in 0..1.
    """
    if not agx:
        return srgb_from_linear(color.clamp(0, 1))
    low, high = -12.47393, 4.026069
    x = torch.einsum("ij,...jhw->...ihw", _AGX_IN.to(color), color)
    x = ((torch.log2(x.clamp_min(1e-10)) - low) / (high - low)).clamp(0, 1)
    x2 = x * x
    x4 = x2 * x2
    x = 15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232
    return torch.einsum("ij,...jhw->...ihw", _AGX_OUT.to(x), x).clamp(0, 1)


def _luminance(color: Tensor) -> Tensor:
    red, green, blue = LUMINANCE_WEIGHTS
    return red * color[:, :, 0:1] + green * color[:, :, 1:2] + blue * color[:, :, 2:3]


def _scalar(value: Tensor) -> Tensor:
    return value[..., None, None, None]


def _vector(value: Tensor) -> Tensor:
    return value[..., None, None]


def _unit(value: Tensor) -> Tensor:
    """The vectors (G, K, 3, ...) at length one; several times faster than torch's own."""
    return value * torch.rsqrt((value * value).sum(2, keepdim=True) + 1e-12)
