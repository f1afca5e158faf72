# SPDX-License-Identifier: Apache-2.0
"""The encoder is an open_clip model with its own preprocessing, and tells looks apart on shapes it never saw."""

import json
import shutil
import time
from pathlib import Path

import numpy as np
import open_clip
import pytest
import torch
from huggingface_hub import constants
from PIL import Image

from lab.train import evaluate
from lab.train.encoder import HELD_OUT
from lab.train.pictures import bank
from lab.train.pictures.shapes import shape
from proxy_renderer.guidance.encoder import EMBEDDED, MERGES, Encoder, load_encoder
from proxy_renderer.schema import VibeError


@pytest.fixture(scope="module")
def encoder() -> Encoder:
    return load_encoder()


def smooth_picture(height: int, width: int) -> np.ndarray:
    """A soft colorful picture (H, W, 3), on which every resampling filter agrees."""
    y, x = np.mgrid[0:height, 0:width] / 40.0
    return (0.5 + 0.4 * np.stack([np.sin(x), np.cos(y), np.sin(x + y)], -1)).astype(np.float32)


def test_embedded_model_loads_through_open_clip_like_any_other(encoder: Encoder) -> None:
    model = open_clip.create_model(f"local-dir:{EMBEDDED}").eval()
    texts = ["a red teapot", "blue fog"]
    with torch.no_grad():
        own_words = {"bpe_path": str(EMBEDDED / MERGES)} if (EMBEDDED / MERGES).is_file() else {}
        tokens = open_clip.get_tokenizer(f"local-dir:{EMBEDDED}", **own_words)(texts)
        own = torch.nn.functional.normalize(model.encode_text(tokens), dim=-1)
    assert torch.allclose(own, encoder.encode_texts(texts), atol=1e-5)
    assert sum(file.stat().st_size for file in EMBEDDED.iterdir()) < 6e6


@pytest.mark.parametrize("size", [(128, 128), (512, 512), (90, 200)])
def test_features_have_unit_length_and_gradients_reach_the_picture(encoder: Encoder, size: tuple[int, int]) -> None:
    picture = torch.rand(2, 3, *size, generator=torch.Generator().manual_seed(0)).requires_grad_()
    features = encoder.encode_images(picture)
    assert torch.allclose(features.norm(dim=1), torch.ones(2), atol=1e-5)
    (features @ encoder.encode_texts(["a green bottle"]).T).sum().backward()
    assert picture.grad is not None
    assert picture.grad.isfinite().all()
    assert picture.grad.abs().sum() > 0


def test_gradient_is_the_slope(encoder: Encoder) -> None:
    base = torch.from_numpy(smooth_picture(128, 128)).permute(2, 0, 1)[None]
    text = encoder.encode_texts(["a bright picture"])

    def similarity(exposure: torch.Tensor) -> torch.Tensor:
        return (encoder.encode_images(base * exposure) @ text.T).sum()

    exposure = torch.tensor(0.8, requires_grad=True)
    (slope,) = torch.autograd.grad(similarity(exposure), exposure)
    with torch.no_grad():
        difference = (similarity(torch.tensor(0.805)) - similarity(torch.tensor(0.795))) / 0.01
    assert slope.item() == pytest.approx(difference.item(), rel=0.05, abs=1e-3)


@pytest.mark.parametrize("mode", ["squash", "shortest", "longest"])
def test_preprocessing_is_the_models_own(tmp_path: Path, mode: str) -> None:
    folder = tmp_path / mode
    shutil.copytree(EMBEDDED, folder)
    config = json.loads((folder / "open_clip_config.json").read_text())
    config["preprocess_cfg"]["resize_mode"] = mode
    (folder / "open_clip_config.json").write_text(json.dumps(config))
    picture = smooth_picture(200, 320)
    own = open_clip.create_model_and_transforms(f"local-dir:{folder}")[2](Image.fromarray(np.uint8(255 * picture)))
    ours = load_encoder(str(folder)).preprocess(torch.from_numpy(picture).permute(2, 0, 1)[None])[0]
    inside = slice(30, 98)  # away from padding, where the fill is a matter of taste
    assert (ours - own)[:, inside, inside].abs().mean() < 0.02


@pytest.mark.slow
def test_looks_of_unseen_shapes_are_told_apart(encoder: Encoder) -> None:
    views = [bank.trace(shape(HELD_OUT + 500 + k), np.random.default_rng(k), 128) for k in range(10)]
    layout = bank.fields(128)
    fresh = {name: np.stack([view[name] for view in views]).astype(layout[name][1]) for name in layout}
    scores = evaluate.judge(encoder, evaluate.shaded(fresh, 2))
    assert scores["attribute_flip"] > 0.62
    assert scores["swap"] > 0.72
    least = {"subject_color": 0.7, "surroundings_color": 0.85, "brightness": 0.85, "saturation": 0.8, "vignette": 0.85}
    assert all(scores["heads"][name] > share for name, share in least.items()), scores["heads"]


@pytest.mark.parametrize("tag", ["nonsense", "ViT-B-32-256/nonsense", "RN50/", "../nowhere"])
def test_an_unknown_encoder_names_the_remedy(tag: str) -> None:
    with pytest.raises(VibeError, match="encoder") as caught:
        load_encoder(tag)
    assert "embedded" in caught.value.remedy


def test_a_folder_without_a_model_is_refused(tmp_path: Path) -> None:
    with pytest.raises(VibeError, match="open_clip_config"):
        load_encoder(str(tmp_path))
    shutil.copy(EMBEDDED / "open_clip_config.json", tmp_path)
    with pytest.raises(VibeError, match="cannot be loaded"):
        load_encoder(str(tmp_path))


def test_a_hub_out_of_reach_fails_at_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(constants, "ENDPOINT", "http://127.0.0.1:9")
    monkeypatch.setattr(constants, "HF_HUB_CACHE", str(tmp_path))
    start = time.monotonic()
    with pytest.raises(VibeError, match="cannot be downloaded") as caught:
        load_encoder("ViT-B-32-256/datacomp_s34b_b86k")
    assert "internet" in caught.value.remedy
    assert time.monotonic() - start < 20
