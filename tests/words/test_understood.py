# SPDX-License-Identifier: Apache-2.0
"""A prompt is read once, for everyone who asks what it says."""

from __future__ import annotations

import pytest

from proxy_renderer.schema import VibeError
from proxy_renderer.words import parser as module
from proxy_renderer.words.parser import Understood
from proxy_renderer.words.types import SceneDescription


def test_a_prompt_is_read_once(monkeypatch):
    read = []
    parse = module.read
    monkeypatch.setattr(module, "read", lambda *given, **more: read.append(given) or parse(*given, **more))
    understood = Understood("glossy teal, warm light", SceneDescription())
    assert [a.entry for a in understood.parsed.attributes][:2] == ["glossy", "teal"]
    assert understood.parsed is understood.parsed
    assert len(read) == 1


@pytest.mark.parametrize("prompt", ["", "hello there", "x" * 100_000])
def test_what_is_not_understood_is_said_whenever_it_is_asked_for(prompt):
    understood = Understood(prompt, SceneDescription())
    assert understood.unknown
    for _ in range(2):
        with pytest.raises(VibeError) as caught:
            understood.parsed  # noqa: B018
        assert caught.value is understood.unknown
