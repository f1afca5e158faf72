# SPDX-License-Identifier: Apache-2.0
"""GGX lobes and the layers made of them: closed forms, a direct integral of the BRDF, Fresnel's equations."""

import math
from dataclasses import replace

import torch
from operation_tests import OperationTests, colors, number
from torch import Tensor

from lab.bench.scenes import balls
from proxy_renderer.render.lights.area_specular import AreaSpecular
from proxy_renderer.render.material.albedo import basis
from proxy_renderer.render.material.inputs import shading_inputs_of
from proxy_renderer.render.surface import principled
from proxy_renderer.render.surface.principled import IncidentLight, ReflectedRadiance
from proxy_renderer.scene.values import RenderValues

COSINES = torch.tensor([0.25, 0.5, 0.75, 1.0], dtype=torch.float64)
VIEW = basis(COSINES)
EACH = torch.ones(4, dtype=torch.float64)
ONE, ZERO = torch.ones(1, dtype=torch.float64), torch.zeros(1, dtype=torch.float64)


def ggx_albedo(roughness: float, cosines: Tensor, steps: int = 600) -> list[float]:
    """Integral of D G2 / (4 cos) over the hemisphere of light, by the midpoint rule (Heitz 2014)."""
    alpha2 = roughness**4
    theta = ((torch.arange(steps, dtype=torch.float64) + 0.5) / steps * math.pi / 2)[:, None]
    phi = ((torch.arange(steps, dtype=torch.float64) + 0.5) / steps * math.pi)[None]
    x, y, z = theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos().expand(steps, steps)
    result = []
    for cosine in cosines.tolist():
        half2 = (x + math.sqrt(1 - cosine**2)) ** 2 + y**2 + (z + cosine) ** 2
        up2 = (z + cosine) ** 2 / half2
        density = alpha2 / (math.pi * (up2 * (alpha2 - 1) + 1) ** 2)
        light, eye = ((1 + alpha2 * (1 / c**2 - 1)) ** 0.5 for c in (z, torch.tensor(cosine).double()))
        brdf = density * 2 / (light + eye) / (4 * cosine)
        result.append(float((2 * brdf * theta.sin()).sum() * (math.pi / 2 / steps) * (math.pi / steps)))
    return result


class TestSingleScattering(OperationTests):
    """The albedo is a sum over seven functions of the cosine, fitted to a coarse quadrature: it comes within 2 %."""

    rtol, atol = 0.02, 0.0
    operation = staticmethod(lambda roughness, view: principled.single_scattering(roughness, view)[0])
    inputs = (torch.tensor([0.3, 0.45, 0.6, 0.9], dtype=torch.float64), VIEW)
    shape = (4,)
    wrong = (torch.tensor(0.5), torch.rand(6, 4))
    values = tuple(((r * EACH, VIEW), ggx_albedo(r, COSINES)) for r in (0.4, 0.7, 1.0))


class TestMultipleScattering(OperationTests):
    """The geometric series of bounces; a white surface loses nothing."""

    operation = staticmethod(principled.multiple_scattering)
    inputs = (colors(4).T, COSINES)
    shape = (3, 4)
    wrong = (torch.rand(3, 4), torch.rand(3))
    values = (
        ((torch.tensor([1.0, 0.0]), torch.tensor([0.3, 0.3])), [1.0, 0.0]),
        ((torch.tensor([0.6]), torch.tensor([0.7])), sum(0.6 * 0.7 * (0.6 * 0.3) ** k for k in range(30))),
    )


class TestSummed(OperationTests):
    operation = staticmethod(lambda lamps, one, two: principled.summed(lamps, [one, two]))
    inputs = (colors(2), COSINES, 2 * COSINES)
    shape = (3, 4)
    wrong = (torch.rand(2, 4), torch.rand(4), torch.rand(4))
    values = (
        (
            (torch.tensor([[1.0, 2.0, 3.0], [0.0, 1.0, 0.0]]), torch.tensor([1.0, 10.0]), torch.tensor([5.0, 0.0])),
            [[1.0, 10.0], [7.0, 20.0], [3.0, 30.0]],
        ),
    )


class TestReflectedRadiance(OperationTests):
    """At a knot its image, halfway between two their mean, beyond the last the last."""

    operation = staticmethod(lambda roughness, *images: ReflectedRadiance((0.0, 0.5, 1.0), images).at(roughness))
    inputs = (torch.tensor([0.2, 0.4, 0.6, 0.9], dtype=torch.float64), *(k * colors(4).T for k in (1, 2, 5)))
    shape = (3, 4)
    wrong = (torch.tensor(0.5), *(torch.rand(2, 4),) * 3)
    IMAGES = tuple(torch.full((3, 3), value) for value in (1.0, 2.0, 6.0))
    values = (
        ((torch.tensor([0.0, 0.25, 0.5]), *IMAGES), [1.0, 1.5, 2.0]),
        ((torch.tensor(0.75), *IMAGES), 4.0),
        ((torch.tensor(1.0), *IMAGES), 6.0),
    )


class _LobeTests(OperationTests):
    """A light of radiance 1 seen straight from above: its share of the distribution of slopes."""

    operation = staticmethod(
        lambda roughness, strength, into, out, outline: AreaSpecular(
            strength, torch.zeros_like(strength).expand(7, -1), into, out, outline
        ).lobe(roughness)
    )
    shape = (1,)
    wrong = (torch.tensor(0.5), ONE, ZERO, torch.zeros(2), torch.rand(5, 1))


OUTLINE = torch.tensor([[0.0], [0.04], [0.0], [1.0], [0.08]], dtype=torch.float64)
FAR = 1e5


class TestLobeOfADisc(_LobeTests):
    """Around the mirror direction a disc of slopes up to s holds s² / (s² + alpha²) of GGX."""

    inputs = (
        number(0.4), ONE, 0.2 * ONE, 0.3 * ONE, torch.tensor([[0.09], [0.03], [0.02], [0.9], [0.07]], dtype=torch.float64)
    )  # fmt: skip
    values = tuple(((number(r), ONE, ZERO, ZERO, OUTLINE), 0.04 / (0.04 + r**4)) for r in (0.2, 0.5, 1.0))


class TestLobeOfARectangle(_LobeTests):
    """The plane of slopes holds the whole lobe, a half plane half, a strip of ±s the share s / sqrt(s² + alpha²)."""

    inputs = (
        number(0.4), ONE, 0.2 * ONE, 0.3 * ONE, torch.tensor([[-0.1], [0.3], [0.05], [0.2]], dtype=torch.float64)
    )  # fmt: skip
    values = tuple(
        ((number(0.5), ONE, ZERO, ZERO, torch.tensor(sides, dtype=torch.float64)[:, None]), share)
        for sides, share in (
            ((-FAR, FAR, -FAR, FAR), 1.0),
            ((0.0, FAR, -FAR, FAR), 0.5),
            ((0.0, FAR, 0.0, FAR), 0.25),
            ((-0.25, 0.25, -FAR, FAR), math.sqrt(0.5)),
        )
    )


SCENE = balls(1, 0, 1)
PLAIN = shading_inputs_of(SCENE.materials[0], RenderValues(SCENE, {}, "cpu"))


def even(view: Tensor, radiance: Tensor) -> IncidentLight:
    """The same radiance () from everywhere, no lamps."""
    image = radiance * torch.ones(3, view.shape[1], dtype=radiance.dtype)
    return IncidentLight(math.pi * image, torch.zeros(0, 3), [], view, ReflectedRadiance((0.0, 1.0), [image] * 2), None)


def coated(weight: Tensor, roughness: Tensor, view: Tensor, radiance: Tensor) -> Tensor:
    """What a clear lacquer reflects, and what it leaves (4, N)."""
    inputs = replace(PLAIN, coat=weight, coat_roughness=roughness)
    reflected, left = principled.coat(inputs, even(view, radiance))
    return torch.cat((reflected, left[None]))


def fresnel(cosine: float, ior: float = 1.5) -> float:
    """Fresnel's equations by the refracted angle: mean of both polarizations."""
    behind = math.sqrt(1 - (1 - cosine**2) / ior**2)
    across = (cosine - ior * behind) / (cosine + ior * behind)
    along = (behind - ior * cosine) / (behind + ior * cosine)
    return (across**2 + along**2) / 2


class TestCoat(OperationTests):
    """Smooth lacquer of IOR 1.5 in a furnace of radiance 1 reflects as Fresnel says, and leaves the rest."""

    rtol, atol = 0.0, 4e-3  # tables and a fit
    operation = staticmethod(coated)
    inputs = (number(0.7), 0.3 * EACH, VIEW, number(1.0))
    shape = (4, 4)
    wrong = (number(1.0), 0.3 * EACH, torch.rand(6, 4), number(1.0))
    FRESNEL = torch.tensor([fresnel(c) for c in COSINES.tolist()])
    values = (
        ((number(1.0), 0.03 * EACH, VIEW, number(1.0)), torch.stack((FRESNEL, FRESNEL, FRESNEL, 1 - FRESNEL))),
        ((number(0.0), 0.3 * EACH, VIEW, number(1.0)), [[0.0]] * 3 + [[1.0]]),
    )

    def test_a_furnace_loses_nothing(self):
        """Whatever its roughness: light that is not reflected is left to the layers below."""
        result = coated(number(0.6), torch.tensor([0.1, 0.4, 0.7, 1.0]).double(), VIEW, number(1.0))
        torch.testing.assert_close(result[:3] + result[3], torch.ones_like(result[:3]), rtol=0, atol=1e-6)


def fuzzy(weight: Tensor, view: Tensor, radiance: Tensor, tint: float = 1.0) -> Tensor:
    """What sheen of a gray tint reflects, and what it leaves (4, N)."""
    inputs = replace(PLAIN, sheen=weight, sheen_tint=(tint,) * 3)
    reflected, left = principled.sheen(inputs, even(view, radiance))
    return torch.cat((reflected, left[None]))


class TestSheen(OperationTests):
    """None changes nothing, black fibers take nothing away; in a furnace white ones and what they leave make 1."""

    operation = staticmethod(fuzzy)
    inputs = (number(0.7), VIEW, number(1.3))
    shape = (4, 4)
    wrong = (number(0.7), torch.rand(6, 4), number(1.0))
    values = (
        ((number(0.0), VIEW, number(1.0)), [[0.0]] * 3 + [[1.0]]),
        ((number(0.7), VIEW, number(1.0), 0.0), [[0.0]] * 3 + [[1.0]]),
    )

    def test_a_furnace_loses_nothing(self):
        result = fuzzy(number(0.7), VIEW, number(1.0))
        assert (result[0] > 0.01).all()
        torch.testing.assert_close(result[:3] + result[3], torch.ones_like(result[:3]), rtol=0, atol=1e-6)
