# SPDX-License-Identifier: Apache-2.0
"""The check before Blender starts refuses only what says nothing in any scene, and reads no targets."""

import pytest

from proxy_renderer.schema import VibeError
from proxy_renderer.words import parser


@pytest.mark.parametrize(
    "prompt", ["kupferne Tasse, warmes Licht", "théière rouge brillante", "赤いティーポット", "teal water"]
)
def test_other_languages_and_what_the_scene_may_lack_are_not_refused(prompt):
    parser.refuse_without_look(prompt)


@pytest.mark.parametrize("prompt", ["", "qwxz hello", "add a second dragon", "x" * 5000, "🔥"])
def test_what_says_nothing_is_refused_with_a_remedy(prompt):
    with pytest.raises(VibeError) as caught:
        parser.refuse_without_look(prompt)
    assert caught.value.remedy


def test_nothing_is_bound(monkeypatch):
    monkeypatch.setattr(parser, "read_words", None)
    parser.refuse_without_look("glossy red cup")
