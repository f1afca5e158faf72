# SPDX-License-Identifier: Apache-2.0
"""The quantity that a parameter belongs to."""

import pytest
import torch

from proxy_renderer.claims.measures import MEASURES
from proxy_renderer.claims.measures.picture import MeasuredPicture
from proxy_renderer.render.surface.view_cache import GBuffer
from proxy_renderer.schema import VibeError
from proxy_renderer.words.lexicon.quantities import quantities, read_claim

EVERYWHERE = torch.ones(32, 32, dtype=torch.bool)
GRAY = MeasuredPicture(
    torch.full((32, 32, 3), 0.5),
    GBuffer(
        torch.ones(32, 32), torch.zeros(32, 32, dtype=torch.int64), ("",), torch.zeros(32, 32, 3),
        torch.ones(32, 32), torch.ones(32, 32),
    ),
)  # fmt: skip


def test_the_most_specific_row_counts():
    table = quantities()
    assert table.of_parameter("rim", "light/power", "") == "rim"
    assert table.of_parameter("key", "light/power", "") == "brightness"


def test_a_parameter_without_a_quantity_is_named():
    with pytest.raises(VibeError, match="camera/fov"):
        quantities().of_parameter("camera", "camera/fov", "")


def test_a_measure_has_as_many_numbers_in_a_claim_as_it_gives():
    """Those in two directions of color two, colors three, and others one; what a color directs has one."""
    for name, measure in MEASURES.items():
        count = len(measure.take(GRAY, EVERYWHERE, *((torch.tensor([1.0, 0.0]),) if measure.directed else ())))
        ends = ",".join(["1"] * (1 if name == "tint" else count))
        color = " #ff0000" if name in ("tint", "accent") else ""
        text = f"picture {name}{color} {ends}..{ends}"
        assert str(read_claim(text)) == text


@pytest.mark.parametrize(
    "text",
    [
        "picture cast in 0,0.25,1,0.5 -3,-2.5..4,5 x0.5 (its upper third is neutral)",
        "subject cast 1,2..3,4 or +0",
        "picture vividest ..30 or +0",
        "picture lightness 30.5..30.5 x0",
        "thing gloss ..10 or any -9 (matte, as (almost) all clay)",
    ],
)
def test_a_claim_is_written_as_it_is_read(text):
    assert str(read_claim(text)) == text
    assert read_claim(str(read_claim(text))) == read_claim(text)
