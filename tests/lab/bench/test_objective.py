# SPDX-License-Identifier: Apache-2.0
"""The objective as a function of the picture alone, and how alike its gradients are."""

import pytest
import torch
from tiny_job import write_job

from lab.bench.objective import agreement, objective
from proxy_renderer.guidance.encoder import load_encoder
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.scene import load_scene


def test_a_picture_that_shows_the_words_is_worth_more_in_both_terms(tmp_path):
    proxy = Proxy(load_scene(write_job(tmp_path)), (64, 48))
    judge = objective(proxy, "red ball", load_encoder(None, "cpu"))
    red, blue = (
        proxy.render({"material/Ball/base_color": torch.tensor(color)}).display
        for color in ([0.6, 0.03, 0.02], [0.02, 0.03, 0.6])
    )
    assert (judge(red) < judge(blue)).all()


def test_gradients_are_compared_as_wholes_and_term_by_term():
    slopes = {
        "a": {"similarity": (1.0, 1.0), "claims": (0.0, 0.0)},
        "b": {"similarity": (0.0, 0.0), "claims": (1.0, -1.0)},
    }
    assert agreement(slopes) == {"whole": 0.0, "similarity": 1.0, "claims": -1.0}


def test_a_term_that_nothing_changes_has_no_cosine():
    slopes = {"a": {"similarity": (2.0, 1.0), "claims": (0.0, 0.0)}}
    assert agreement(slopes) == {"whole": pytest.approx(1.0), "similarity": pytest.approx(1.0)}
