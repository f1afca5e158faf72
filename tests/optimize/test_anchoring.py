# SPDX-License-Identifier: Apache-2.0
"""When the loop asks for Cycles' pictures, and what becomes of it when there are none."""

from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import torch
from loop_parts import PROMPT, Silent, any_round, search_for

from proxy_renderer.guidance.encoder import load_encoder
from proxy_renderer.optimize import pipeline, shots
from proxy_renderer.optimize.shots import BlenderPictures, ShotInput, gathered
from proxy_renderer.render.cycles import CyclesPicture
from proxy_renderer.render.proxy import Proxy
from proxy_renderer.schema import messages
from proxy_renderer.schema.messages import Options

SIZE = (32, 24)


class Elsewhere:
    """A renderer that shows everything a fifth brighter than the proxy; remembers what it was asked for."""

    def __init__(self, scene, fails=()):
        self.scene, self.fails, self.asked = scene, fails, []

    def __call__(self, values, size):
        self.asked.append(values)
        if len(self.asked) in self.fails:
            return None
        with torch.no_grad():
            tensors = {k: torch.tensor(v) for k, v in values.items()}
            whole = 1.2 * Proxy(self.scene, size).render(tensors).linear
        return CyclesPicture(whole, {"world": 0.5 * whole}, 0.5 * whole)


def run(scene, source, prompt=PROMPT, **options):
    encoder = load_encoder(None, "cpu")
    chosen = Options(**{"rounds": 2, "steps": 4, "size": 48, **options})
    return pipeline.run(search_for([ShotInput(scene, source)], prompt, chosen, encoder, Silent()))


def test_every_round_starts_from_a_picture_and_so_does_the_prediction(scene, monkeypatch):
    monkeypatch.setattr(pipeline, "next_round", any_round)
    source = Elsewhere(scene)
    outcome = run(scene, source, "red ball, bright background")
    assert source.asked[0] == {}
    assert {r["round"] for r in outcome.shots[0].records} == {1, 2}
    last = {k: list(v) for k, v in outcome.vector.values(outcome.u).items() if v != outcome.vector.instances[k].value}
    assert last in source.asked
    assert len(source.asked) == len(outcome.shots[0].records) <= 6
    assert outcome.shots[0].anchor.correction is not None
    assert outcome.shots[0].records[0]["delta_e"] > outcome.shots[0].records[-1]["delta_e"]


def test_pictures_steer_the_loop(scene):
    assert not torch.equal(run(scene, Elsewhere(scene)).u, run(scene, None).u)


@pytest.mark.slow
def test_a_loop_with_pictures_is_reproducible(scene):
    first, again = (run(scene, Elsewhere(scene)).u for _ in range(2))
    assert torch.equal(first, again)


def test_a_loop_without_pictures_is_the_proxys_own(scene):
    plain, without = run(scene, None), run(scene, lambda values, size: None)
    assert torch.equal(plain.u, without.u)
    assert without.shots[0].records == []


def test_an_old_correction_is_kept_near_and_dropped_far(scene):
    source = Elsewhere(scene, fails=(2, 3))
    vector, (shot,) = gathered([ShotInput(scene, source)], Options(), lambda data: Proxy(data, SIZE))
    u = vector.encode({})
    first = shot.anchored(u, 0)
    assert first.anchored(u, 0) is first
    assert len(shot.records) == 1
    near, far = u.clone(), u.clone()
    part = vector.slices["material/Floor/base_color"]
    near[part] += 0.1
    far[part] -= 0.5
    assert first.anchored(near, 1) is first
    plain = first.anchored(far, 1)
    assert plain.anchor.correction is None
    assert plain.anchored(far, 2).anchor.correction is not None
    assert first.anchor.correction is not None  # whoever goes back to it finds it as it was


def test_each_state_of_a_shot_draws_with_its_own_correction(scene):
    _, (shot,) = gathered([ShotInput(scene, Elsewhere(scene))], Options(), lambda data: Proxy(data, SIZE))
    u = shot.vector.encode({})
    plain = shot.draw(u).linear
    corrected = shot.anchored(u, 0)
    brighter = corrected.draw(u).linear
    assert float(brighter.mean()) > 1.1 * float(plain.mean())
    shot._last = corrected._last = None
    assert torch.equal(shot.draw(u).linear, plain)
    assert torch.equal(corrected.draw(u).linear, brighter)


def exr(path: Path, size=SIZE) -> None:
    gray = np.full((size[1], size[0], 3), 0.2, np.float32)
    layers = {f"ViewLayer.{n}": gray for n in ("Combined", "Noisy Image", "Combined_Vibe 0")}
    OpenEXR.File({"type": OpenEXR.scanlineimage}, layers).write(str(path))


def answers(scene, *given):
    """A Blender that answers with these, one after the other: an error, or a picture's width and height."""
    queue = list(given)
    asked = []

    def ask(request):
        asked.append(request)
        answer = queue.pop(0)
        if not isinstance(answer, tuple):
            return answer and messages.Anchored(request.number, error=answer)
        exr(scene.folder / "a.exr", answer)
        return messages.Anchored(request.number, "a.exr", {"Vibe 0": "world"}, seconds=1.25)

    return BlenderPictures(scene, ask, seed=5), asked


def test_blenders_pictures_are_read_and_removed(scene):
    blender, asked = answers(scene, SIZE)
    picture = blender({"film/contrast": [1.2]}, SIZE)
    assert picture.parts["world"].mean() == pytest.approx(0.2)
    assert asked == [messages.Anchor(1, {"film/contrast": [1.2]}, 32, shots.SAMPLES, 5)]
    assert blender.seconds == [1.25]
    assert not (scene.folder / "a.exr").exists()


def test_what_goes_wrong_is_noted_once_and_the_second_time_is_the_last(scene):
    blender, asked = answers(scene, "out of memory", SIZE, (8, 8), "out of memory", SIZE)
    found = [blender({}, SIZE) for _ in range(5)]
    assert [picture is not None for picture in found] == [False, True, False, False, False]
    assert len(asked) == 4
    assert "out of memory" in blender.notes[0]
    assert "pixels" in blender.notes[1]
    assert len(blender.notes) == 2


def test_a_vibe_that_ends_is_no_failure(scene):
    blender, _ = answers(scene, None)
    assert blender({}, SIZE) is None
    assert blender.notes == []


def test_slow_pictures_are_the_last(scene, monkeypatch):
    monkeypatch.setattr(shots, "LONGEST", 1.0)
    blender, asked = answers(scene, SIZE, SIZE)
    assert blender({}, SIZE) is not None
    assert blender({}, SIZE) is None
    assert len(asked) == 1
    assert "too long" in blender.notes[0]
