# SPDX-License-Identifier: Apache-2.0
"""The heads of the embedded encoder."""

import pytest
import torch

from lab.heads import heads_of
from lab.heads.attributes import ATTRIBUTES
from proxy_renderer.guidance.encoder import load_encoder


@pytest.fixture(scope="module")
def encoder():
    return load_encoder()


def test_heads_read_the_attributes_of_the_language(encoder):
    heads = heads_of(encoder)
    assert heads is not None
    assert heads.names == {name: list(classes) for name, classes in ATTRIBUTES.items()}
    logits = heads.logits(encoder.encode_images(torch.rand(3, 3, 64, 64)))
    assert {name: tuple(value.shape) for name, value in logits.items()} == {
        n: (3, len(c)) for n, c in ATTRIBUTES.items()
    }


def test_surfaces_are_read_off_the_subject_alone(encoder):
    heads = heads_of(encoder)
    assert heads is not None
    whole, subject = encoder.encode_images(torch.rand(2, 3, 64, 64)).split(1)
    read, of_whole, of_subject = heads.read(whole, subject), heads.logits(whole), heads.logits(subject)
    for name in heads.names:
        seen = of_subject if name in ("subject_finish", "subject_metal") else of_whole
        assert torch.equal(read[name], seen[name])
        assert not torch.equal(of_subject[name], of_whole[name])
