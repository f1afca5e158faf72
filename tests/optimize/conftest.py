# SPDX-License-Identifier: Apache-2.0
"""A small scene and the embedded encoder, for the tests of the loop."""

import pytest
from tiny_job import write_job

from proxy_renderer.guidance.encoder import load_encoder
from proxy_renderer.optimize.vector import ParameterVector
from proxy_renderer.scene import load_scene


@pytest.fixture(scope="module")
def encoder():
    return load_encoder(None, "cpu")


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    return load_scene(write_job(tmp_path_factory.mktemp("job")))


@pytest.fixture(scope="module")
def vector(scene):
    return ParameterVector(scene.instances)
