# SPDX-License-Identifier: Apache-2.0
"""Image files of a vibe: text on sheets, and how far predictions are from Cycles' picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from proxy_renderer.engine import pictures
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


@pytest.mark.parametrize("prompt", ["soft warm light, glossy teal, " * 20, "車はマットな赤、窓からの冷たい光" * 9])
def test_long_prompts_are_wrapped_and_cut(prompt, fonts):
    face = font(26, prompt, fonts)
    lines = wrapped(prompt, face, 600.0, 4)
    assert len(lines) == 4
    assert max(map(face.getlength, lines)) <= 600.0
    assert lines[-1].endswith(" …")
    assert "".join(lines).replace(" ", "").startswith(prompt[:40].replace(" ", ""))


BLACK = np.zeros((10, 10, 3), np.float32)


def test_the_subject_and_the_worst_pixels_are_told_apart_from_the_mean():
    after, subject = BLACK.copy(), np.zeros((10, 10), np.float32)
    after[0] = 1.0
    subject[0, :5] = subject[1, :5] = 1.0
    figures = pictures.difference(BLACK, after, subject)
    assert figures["mean"] == pytest.approx(10, abs=1e-2)
    assert figures["subject"] == pytest.approx(50, abs=1e-2)
    assert figures["p95"] == pytest.approx(100, abs=1e-2)


def test_a_subject_that_nobody_sees_has_no_figure():
    assert set(pictures.difference(BLACK, BLACK, BLACK[..., 0])) == {"mean", "p95"}
