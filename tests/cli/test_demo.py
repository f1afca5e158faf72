# SPDX-License-Identifier: Apache-2.0
"""`vibe demo`: its own words, and a picture in their place."""

import pytest

from proxy_renderer.cli import main as commands
from proxy_renderer.cli.main import main


@pytest.mark.parametrize(
    ("options", "prompt"),
    [([], commands.DEMO_PROMPT), (["--like", "a.jpg"], ""), (["--like", "a.jpg", "--prompt", "colder"], "colder")],
)
def test_a_picture_takes_the_place_of_the_demos_own_words(monkeypatch, options, prompt):
    asked = []
    monkeypatch.setattr(commands, "carry_out", lambda a, kind: asked.append(a.prompt) or 0)
    assert main(["demo", *options]) == 0
    assert asked == [prompt]
