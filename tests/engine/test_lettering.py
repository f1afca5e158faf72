# SPDX-License-Identifier: Apache-2.0
"""Prompts on pictures: no letter is missing in the languages that are understood, and no line is too long."""

from pathlib import Path

import pytest

from proxy_renderer.engine.pictures import font, wrapped

MISSING = "\u0378"  # no letter: drawn as what stands for one that a font lacks


@pytest.fixture(scope="session")
def fonts():
    bpy = pytest.importorskip("bpy")
    return Path(bpy.utils.system_resource("DATAFILES", path="fonts"))


@pytest.mark.parametrize("prompt", ["pálido moosgrün façade £", "つや消しの赤", "浅绿色", "glossy teal"])
def test_no_letter_of_a_prompt_is_missing(prompt, fonts):
    face = font(26, prompt, fonts)
    lacks = bytes(face.getmask(MISSING))
    assert [letter for letter in prompt if bytes(face.getmask(letter)) == lacks] == []


def test_without_blenders_fonts_there_are_plain_letters():
    assert font(26, "glossy teal", Path("nowhere")).getlength("glossy teal") > 0


@pytest.mark.parametrize(
    "prompt", ["soft warm light, glossy teal, " * 20, "車はマットな赤、窓からの冷たい光" * 9]
)
def test_long_prompts_are_wrapped_and_cut(prompt, fonts):
    face = font(26, prompt, fonts)
    lines = wrapped(prompt, face, 600.0, 4)
    assert len(lines) == 4
    assert max(map(face.getlength, lines)) <= 600.0
    assert lines[-1].endswith(" …")
    assert "".join(lines).replace(" ", "").startswith(prompt[:40].replace(" ", ""))
