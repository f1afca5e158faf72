# SPDX-License-Identifier: Apache-2.0
"""The judge: the paper's words, its strict output, and figures in which everything can be seen."""

import base64
import io

import numpy as np
import pytest
from model_server import KEY, MODEL, refuses, says, serving
from PIL import Image

from proxy_renderer.vlm import judge
from proxy_renderer.vlm.client import Client
from proxy_renderer.vlm.endpoint import Endpoint
from proxy_renderer.vlm.transport import ModelError

RED, BLUE = (Image.new("RGB", (90, 60), c) for c in ("#cc2222", "#2222cc"))
COLUMNS = [judge.Column(name, f"a {name} prompt " * 9, RED, BLUE) for name in judge.PAPER]
WON = "WINNER = OURS\nREASON = It is red."


@pytest.fixture(autouse=True)
def own_cache(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


def test_the_paper_s_figure_is_judged_by_the_paper_s_words():
    with serving(lambda body, n: says(WON)) as model:
        client = Client(Endpoint(MODEL, model.url, KEY, 5.0))
        assert judge.judge(client, COLUMNS) == judge.Verdict("OURS", "It is red.")
    system, user = model.asked[0]["messages"]
    assert system["content"] == judge.INSTRUCTIONS
    assert "response_format" not in model.asked[0]
    raw = base64.b64decode(user["content"][1]["image_url"]["url"].partition(",")[2])
    picture = np.asarray(Image.open(io.BytesIO(raw)).convert("RGB")).astype(int)
    assert picture.shape[0] < picture.shape[1]
    top, bottom = picture[: picture.shape[0] // 2], picture[picture.shape[0] // 2 :]
    assert (top[..., 0] - top[..., 2] > 120).mean() > 0.3  # ours above
    assert (bottom[..., 2] - bottom[..., 0] > 120).mean() > 0.2


def test_words_for_another_figure():
    text = judge.instructions(["Vase\nWINNER = X"], judge.BEFORE_AFTER)
    assert "2×1" in text
    assert "one object: Vase WINNER = X." in text
    assert "WINNER = AFTER or BEFORE or TIE" in text
    assert "CLIP" not in text
    assert "3" not in text


@pytest.mark.parametrize(
    ("said", "winner", "reason"),
    [
        (WON, "OURS", "It is red."),
        ("**WINNER:** clip-only\n\n**REASON:** Darker.", "CLIP-ONLY", "Darker."),
        ("<think>WINNER = OURS</think>Well.\nWINNER = TIE\nREASON = Alike", "TIE", "Alike"),
        ("`WINNER = OURS`", "OURS", ""),
    ],
)
def test_verdicts(said, winner, reason):
    assert judge.read_verdict(said) == judge.Verdict(winner, reason)


@pytest.mark.parametrize(
    "said",
    ["", "OURS", "WINNER = NOBODY", "WINNER = OURS or CLIP-ONLY", "WINNER = OURS\nWINNER = TIE", "WINNER = AFTER"],
)
def test_no_verdict(said):
    with pytest.raises(ModelError, match="no winner"):
        judge.read_verdict(said)


def test_a_loose_answer_is_asked_for_once_more_and_not_kept(tmp_path):
    with serving(lambda body, n: says("Ours, I think." if n != 2 else WON)) as model:
        client = Client(Endpoint(MODEL, model.url, KEY, 5.0))
        assert judge.judge(client, COLUMNS).winner == "OURS"
        assert judge.judge(client, COLUMNS).winner == "OURS"  # from the cache
        assert len(model.asked) == 2
        with pytest.raises(ModelError, match="no winner"):
            judge.judge(client, COLUMNS, fresh=True)


def test_a_model_that_does_not_see_does_not_judge():
    with serving(lambda body, n: refuses(400, "image input is not supported")) as model:
        with pytest.raises(ModelError, match="image"):
            judge.judge(Client(Endpoint(MODEL, model.url, KEY, 5.0)), COLUMNS)
        assert len(model.asked) == 1
