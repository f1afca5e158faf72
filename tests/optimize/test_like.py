# SPDX-License-Identifier: Apache-2.0
"""The loop with a picture in the place of words: it comes to look like that picture, and not like another one."""

import numpy as np
import OpenEXR
import pytest
import torch
from loop_parts import Silent, search_for
from PIL import Image

from proxy_renderer.color.tensors import lab_from_srgb
from proxy_renderer.optimize import pipeline
from proxy_renderer.optimize.shots import ShotInput
from proxy_renderer.schema import VibeError
from proxy_renderer.schema.messages import Options

BLUE, ORANGE = (0.10, 0.16, 0.34), (0.75, 0.5, 0.25)


def still(path, color):
    """A picture of no thing: light above, dark below, of one color."""
    ramp = np.linspace(1.3, 0.4, 48)[:, None, None]
    shown = (ramp * np.array(color) * np.ones((48, 64, 1))).clip(0, 1)
    Image.fromarray((shown * 255).astype(np.uint8)).save(path)
    return str(path)


@pytest.fixture
def liked(scene, encoder, tmp_path):
    def run(color, prompt="", **options):
        like = still(tmp_path / "still.png", color)
        chosen = Options(like=like, **{"rounds": 1, "steps": 4, "size": 48, **options})
        return pipeline.run(search_for([ShotInput(scene)], prompt, chosen, encoder, Silent()))

    return run


def mean(outcome):
    with torch.no_grad():
        return lab_from_srgb(outcome.shots[0].draw(outcome.u).display).mean((0, 1))


@pytest.mark.slow
def test_the_picture_and_nothing_else_decides(liked):
    blue, orange = liked(BLUE), liked(ORANGE)
    assert mean(blue)[2] < -5.0 < 5.0 < mean(orange)[2]
    assert mean(blue)[0] + 10 < mean(orange)[0]
    assert any(claim.word.startswith("still.png: ") and claim.reason for claim in blue.claims)
    assert any("its look is taken over, not its content" in note for note in blue.plan.notes)
    assert any("film/exposure" in note for note in blue.plan.notes)


def test_only_what_is_asked_for_changes(liked):
    outcome = liked(BLUE, like_only=("grade",))
    assert {key.partition("/")[0] for key in outcome.vector.changes(outcome.u)} == {"film"}
    assert mean(outcome)[2] < -5.0


def test_a_panorama_turns_and_colors_the_key_light(scene, encoder, tmp_path):
    sky = np.full((64, 128, 3), (0.2, 0.3, 0.5), np.float32)
    sky[20:22, 40:42] = (900.0, 540.0, 270.0)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": sky}).write(str(tmp_path / "sky.exr"))
    chosen = Options(like=str(tmp_path / "sky.exr"), rounds=1, steps=2, size=48)
    found = pipeline.run(search_for([ShotInput(scene)], "", chosen, encoder, Silent()))
    (key,) = (light.name for light in scene.lights if light.role == "key")
    values = found.vector.values(found.u)
    azimuth = 90.0 + (0.5 - 41 / 128) * 360.0
    assert (values[f"light/{key}/azimuth"][0] - azimuth + 180) % 360 - 180 == pytest.approx(0.0, abs=5.0)
    red, green, blue = values[f"light/{key}/color"]
    assert red > green > blue


@pytest.mark.slow
def test_words_count_more_than_the_picture(liked):
    assert mean(liked(BLUE, "warm light"))[2] > mean(liked(BLUE))[2] + 3.0


def test_a_locked_scene_is_said_in_a_line(liked):
    with pytest.raises(VibeError, match="Nothing that the picture speaks of may change"):
        liked(BLUE, lock=("light", "world", "film", "volume", "material"))


def test_a_look_that_was_hidden_in_this_very_scene_is_found(scene, encoder, tmp_path):
    """Only the goal picture is shown; it lies nearer to the result than to where the loop began."""
    hidden = {"film/contrast": (1.3,), "film/saturation": (0.6,), "film/gain": (1.1, 0.95, 0.8)}
    options = {"rounds": 2, "steps": 8, "size": 64}
    start = pipeline.run(
        search_for([ShotInput(scene)], "very dark", Options(rounds=1, steps=1, size=64), encoder, Silent())
    )
    shot, vector = start.shots[0], start.vector
    hidden = {key: value for key, value in hidden.items() if key in vector.slices}
    assert len(hidden) == 3
    with torch.no_grad():
        before, goal = (shot.draw(vector.encode(values)).display for values in ({}, hidden))
    Image.fromarray((goal.numpy() * 255 + 0.5).astype(np.uint8)).save(tmp_path / "goal.png")
    chosen = Options(like=str(tmp_path / "goal.png"), like_only=("grade",), like_same=True, **options)
    found = pipeline.run(search_for([ShotInput(scene)], "", chosen, encoder, Silent()))
    with torch.no_grad():
        after = found.shots[0].draw(found.u).display
    start_error, error = ((lab_from_srgb(p) - lab_from_srgb(goal)).norm(dim=-1).mean() for p in (before, after))
    assert error < 0.25 * start_error
    assert error < 1.5
