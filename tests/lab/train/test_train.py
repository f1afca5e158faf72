# SPDX-License-Identifier: Apache-2.0
"""The training recipe: pictures show what captions say, and a sitting resumes exactly where it stopped."""

import random
from pathlib import Path

import numpy as np
import pytest
import torch

from lab.heads import heads_of
from lab.heads.attributes import ATTRIBUTES
from lab.train.data import LOOKS, choices, contradicts, gather, make_batch
from lab.train.evaluate import skill
from lab.train.pictures import bank as banks
from lab.train.pictures import dense, looks, shader, visible
from lab.train.pictures.augment import EMPTY, WHOLE
from lab.train.pictures.shapes import FAMILIES, shape
from lab.train.pictures.surfaces import bent, box, ellipsoid, merge
from lab.train.text import captions, wording
from lab.train.train import Trainer, TrainingRecipe
from proxy_renderer.guidance import encoder
from proxy_renderer.guidance.encoder import load_encoder
from proxy_renderer.schema import VibeError

SIZE = 64
TINY = {
    "embed_dim": 32,
    "vision_cfg": {"image_size": SIZE, "layers": [1, 1, 1, 1], "width": 8, "head_width": 32},
    "text_cfg": {"context_length": 24, "width": 16, "heads": 2, "layers": 1},
}


@pytest.fixture(scope="module")
def bank(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    folder = tmp_path_factory.mktemp("train") / "bank"
    banks.build(folder, views=24, shapes=12, first_seed=0, size=SIZE, workers=1)
    return banks.load(folder)


def classes(**wanted: str) -> torch.Tensor:
    """The classes (1, A) of a plain look with some attributes set by name."""
    plain = {"subject_color": "red", "surroundings_color": "white", "subject_finish": "matte", "subject_metal": "dielectric",
             "light_side": "front", "light_softness": "soft", "light_temperature": "neutral", "fog": "none",
             "brightness": "medium", "contrast": "medium", "saturation": "natural", "vignette": "none"}  # fmt: skip
    return torch.tensor([[ATTRIBUTES[name].index((plain | wanted)[name]) for name in ATTRIBUTES]])


def render(bank: dict[str, np.ndarray], row: int, wanted: torch.Tensor) -> torch.Tensor:
    """The picture (3, H, W) of one view under one look with middling noise."""
    view = {name: torch.from_numpy(np.stack([values[row]])) for name, values in bank.items()}
    look = looks.parameters(wanted[None], torch.full((1, 1, looks.NOISE), 0.45))
    return shader.shade(gather(view, wanted[None]), look, agx=False)[0, 0, :3]


@pytest.mark.parametrize("family", range(len(FAMILIES)))
def test_every_family_gives_different_sound_shapes(family: int) -> None:
    first, again, other = shape(family), shape(family), shape(family + len(FAMILIES))
    assert np.array_equal(first.triangles, again.triangles)
    assert first.triangles.shape != other.triangles.shape or not np.allclose(first.triangles, other.triangles)
    assert np.isfinite(first.normals).all()
    assert np.linalg.norm(first.triangles.reshape(-1, 3), axis=1).max() < 2.3
    assert first.triangles[..., 2].min() == pytest.approx(0, abs=1e-6)


def test_attributes_change_what_they_name(bank: dict[str, np.ndarray]) -> None:
    row = int(np.argmax((bank["kind"] == banks.SUBJECT).mean((1, 2))))
    mask = torch.from_numpy(np.array(bank["kind"][row] == banks.SUBJECT))
    plain = render(bank, row, classes())
    assert plain[0][mask].mean() > 1.5 * plain[2][mask].mean()
    assert plain[:, ~mask].mean() > 0.6
    blue = render(bank, row, classes(subject_color="blue"))
    assert blue[2][mask].mean() > blue[0][mask].mean()
    assert torch.allclose(blue[:, ~mask], plain[:, ~mask], atol=1e-6)
    assert render(bank, row, classes(brightness="dark")).mean() < 0.7 * plain.mean()
    assert render(bank, row, classes(vignette="vignette"))[:, 0, 0].mean() < 0.8 * plain[:, 0, 0].mean()
    warm, cool = (render(bank, row, classes(light_temperature=t)) for t in ("warm", "cool"))
    assert (warm[0] - warm[2]).mean() > (cool[0] - cool[2]).mean() + 0.05
    assert render(bank, row, classes(fog="thick"))[:, mask].std() < plain[:, mask].std()


def test_colors_that_cannot_be_seen_are_not_claimed() -> None:
    lab = torch.tensor([[45.0, 60.0, 42.0], [3.0, 0.5, 0.0], [45.0, 20.0, 14.0]])
    red = torch.full((3,), ATTRIBUTES["subject_color"].index("red"))
    names = visible.color_class(red, lab, torch.zeros(3, dtype=torch.bool))
    assert names.tolist() == [red[0], ATTRIBUTES["subject_color"].index("black"), red[0]]
    gray_blue = torch.tensor([[50.0, -4.0, -22.0]])
    assert visible.color_class(red[:1], gray_blue, torch.zeros(1, dtype=torch.bool)).tolist() == [looks.UNKNOWN]


def test_boxes_are_flat_and_balls_are_bent() -> None:
    cube, ball = box((0, 0, 0), (1, 2, 3)), ellipsoid((5, 0, 0), (1, 1, 1))
    assert bent(cube) == 0.0
    assert bent(ball) == pytest.approx(1.0)
    assert bent(merge([cube, ball])) == pytest.approx(4 * np.pi / (4 * np.pi + 22), rel=0.02)


def test_a_finish_is_asked_of_bent_surfaces_only() -> None:
    y, x = torch.meshgrid(*[torch.linspace(-0.6, 0.6, SIZE)] * 2, indexing="ij")
    ball = torch.stack([x, y, (1 - x**2 - y**2).sqrt()])
    roof = torch.stack([x.sign() * 0.6, 0 * x, 0 * x + 0.8])  # two flat faces
    view = {"kind": torch.full((2, SIZE, SIZE), banks.SUBJECT), "normal": torch.stack([ball, roof]).half(),
            "shadow": torch.zeros(2, 5, 2, SIZE, SIZE)}  # fmt: skip
    glossy = classes(subject_finish="glossy").expand(2, 1, -1)
    gleam = (x.abs() < 0.1).float().expand(2, 1, SIZE, SIZE)
    assert visible.visible_by_light(view, glossy, gleam)["subject_finish"].tolist() == [[True], [False]]


def test_captions_say_every_mentioned_attribute_and_no_other() -> None:
    words = {"subject_color": wording.COLOR_WORDS, "fog": wording.FOG_WORDS, "vignette": wording.VIGNETTE_WORDS}
    dice = random.Random(0)
    for _ in range(300):
        said = {name: dice.choice(list(table)) for name, table in words.items() if dice.random() < 0.6} or {
            "fog": "thick"
        }
        sentence = captions.caption(said, dice).lower()
        phrases = {name for phrase, asks in wording.phrases() if phrase in sentence for name in asks}
        for name, table in words.items():
            names = wording.color_names() if name == "subject_color" else {}
            own = [*table.get(said.get(name, ""), []), *names.get(said.get(name, ""), [])]
            assert name not in said or name in phrases or any(word in sentence for word in own), (said, sentence)
        assert "vignette" in said or not any(w in sentence for ws in wording.VIGNETTE_WORDS.values() for w in ws)


def test_no_picture_contradicts_its_own_caption_and_flips_contradict_their_base(bank: dict[str, np.ndarray]) -> None:
    batch = make_batch(bank, 24, seed=3)
    wrong = contradicts(batch.labels, batch.mentioned)
    assert not wrong.diagonal().any()
    assert wrong.float().mean() > 0.3
    alone = batch.labels[batch.variant == EMPTY]
    assert (alone[:, looks.INDEX["subject_color"]] == looks.UNKNOWN).all()
    whole = batch.labels[batch.variant == WHOLE]
    assert (whole[:, looks.INDEX["subject_color"]] >= 0).float().mean() > 0.4
    assert len(batch.captions) == len(batch.pictures) == 96
    assert batch.pictures.min() >= 0
    assert batch.pictures.max() <= 1


def test_choices_are_between_lessons_about_one_attribute_that_a_picture_shows() -> None:
    a, b = looks.INDEX["fog"], looks.INDEX["contrast"]
    labels = torch.full((2, len(looks.NAMES)), -1)
    labels[0, a], labels[1, b] = 0, 2
    taught = torch.full((5, len(looks.NAMES)), -1)
    taught[0, a], taught[1, a], taught[2, b], taught[3, b] = 0, 1, 2, 0
    taught[4, a], taught[4, b] = 2, 1  # says two
    offered, pairs = choices(labels, taught)
    assert pairs.T.tolist() == [[0, 1], [1, 0], [2, 3], [3, 2]]
    assert offered.nonzero().tolist() == sorted([[a, 0, 0], [b, 1, 2]])


def test_wordings_kept_back_are_not_those_of_training() -> None:
    kept, dice = wording.WordingSplit(held_out=True), random.Random(0)
    for name, table in (("subject_finish", wording.FINISH_WORDS), ("fog", wording.FOG_WORDS)):
        for value, words in table.items():
            trained, back = wording.TRAINED.of(words), kept.of(words)
            assert words[0] in trained
            assert back == words or not {*trained} & {*back}
            said = [captions.caption({name: value}, dice, split=kept) for _ in range(20)]
            assert captions.sayable({name: value}, kept) == (back != words)
            assert all(any(word in sentence for word in back) for sentence in said)
    red, black = {"subject_color": "red"}, {"surroundings_color": "black"}
    assert captions.sayable(red, kept)
    assert not captions.sayable({**red, **black}, kept)
    assert wording.WordingSplit(wording.JUDGES).of(wording.NOUNS) != wording.TRAINED.of(wording.NOUNS)


def test_maps_are_cut_and_mirrored_with_their_pictures(bank: dict[str, np.ndarray]) -> None:
    plain = make_batch(bank, 3, seed=4, augment=False)
    inside = torch.from_numpy((bank["kind"] == banks.SUBJECT).astype(np.float32)).mean((1, 2))
    shares = plain.maps[::LOOKS, 0].mean((1, 2))
    assert all((inside - share).abs().min() < 0.03 for share in shares)
    field = torch.rand(1, dense.CHANNELS, 40, 40)
    whole, turned = (dense.framed(field, (0.0, 0.0, 1.0), mirrored) for mirrored in (False, True))
    assert torch.allclose(turned[:, 1], -whole.flip(-1)[:, 1])
    assert torch.allclose(turned[:, 4], whole.flip(-1)[:, 4])


def test_cycles_pictures_come_first_and_in_pairs(bank: dict[str, np.ndarray]) -> None:
    pictures = np.zeros((4, 3, SIZE, SIZE), np.uint8)
    pictures[2:] = 255
    masks = np.full((4, SIZE, SIZE), 255, np.uint8)
    labels = np.full((4, len(ATTRIBUTES)), 1, np.int64)
    real = {"pictures": pictures, "masks": masks, "labels": labels, "flipped": np.array([-1, 3, -1, -2])}
    batch = make_batch(bank, 2, seed=1, augment=False, real=real)
    assert len(batch.pictures) == 3 * LOOKS
    assert [float(p.std()) == 0 for p in batch.pictures] == [True] * 4 + [False] * 8
    assert torch.equal(batch.pictures[0], batch.pictures[1])
    assert batch.map_weights[:LOOKS].sum() == 0 < batch.map_weights[LOOKS:].sum()
    assert batch.flipped[:LOOKS].tolist() in ([-1, 3, -1, 3], [-1, 3, -1, -2], [-1, -2, -1, 3], [-1, -2, -1, -2])


def test_batches_depend_on_the_seed_alone(bank: dict[str, np.ndarray]) -> None:
    first, again, other = (make_batch(bank, 2, seed) for seed in (5, 5, 6))
    assert torch.equal(first.pictures, again.pictures)
    assert first.captions == again.captions
    assert first.captions != other.captions


@pytest.mark.slow
def test_the_fused_shader_makes_the_same_pictures(bank: dict[str, np.ndarray]) -> None:
    plain, fused = (make_batch(bank, 4, 5, shade=shade) for shade in (shader.shade, shader.fused()))
    assert torch.allclose(plain.pictures, fused.pictures, atol=2e-3)
    assert plain.captions == fused.captions


@pytest.mark.parametrize("roughness", [0.2, 0.4, 0.6])
def test_reflections_are_as_blurred_as_a_ggx_lobe_blurs_them(roughness: float) -> None:
    """The rise of an edge, from a tenth to nine tenths, against sampled half vectors (Walter et al. 2007)."""
    random = np.random.default_rng(0)
    share, turn = random.random(200_000), random.uniform(0, 2 * np.pi, 200_000)
    tangent = roughness**2 * np.sqrt(share / (1 - share))
    off = np.sort(2 * np.arctan(tangent) * np.cos(turn))  # a mirrored ray turns by twice its half vector's angle
    sampled = off[int(0.9 * len(off))] - off[int(0.1 * len(off))]
    at = torch.linspace(0, 12, 20_001)
    half, blur = torch.tensor(6.0), torch.tensor(0.01 + 1.2 * roughness**2)
    edge = shader.blurred(at, half, blur)
    rise = at[int((edge > 0.1).sum())] - at[int((edge > 0.9).sum())]
    assert float(rise) == pytest.approx(sampled, rel=0.25)


def test_blurring_keeps_a_reflected_lights_flux() -> None:
    at = torch.linspace(-40, 40, 80_001)
    flux = [shader.blurred(at, torch.tensor(0.5), torch.tensor(blur)).mean() * 80 for blur in (0.02, 0.4, 2.0)]
    assert [round(float(f), 2) for f in flux] == [1.0, 1.0, 1.0]


def test_smaller_pictures_are_not_aliased(bank: dict[str, np.ndarray]) -> None:
    def glitter(view: dict, look: dict, agx: bool) -> torch.Tensor:
        pictures = shader.shade(view, look, agx)
        pictures[..., :3, :, :] = (torch.arange(SIZE)[:, None] + torch.arange(SIZE)) % 2
        return pictures

    gray = make_batch(bank, 1, 5, augment=False, shade=glitter, size=SIZE * 3 // 5).pictures[..., 2:-2, 2:-2]
    assert float((gray - 0.5).abs().max()) < 0.15


def test_the_tower_tells_left_from_right() -> None:
    picture = torch.zeros(1, 3, 160, 160)
    picture[..., :80] = 1.0
    tower = encoder.vibe_resnet(num_classes=16).eval()
    left, right = tower(picture), tower(picture.flip(-1))
    assert left.shape == (1, 16)
    assert (left - right).norm() > 0.1 * left.norm()


@pytest.mark.slow
def test_training_resumes_bit_for_bit_and_exports(bank: dict[str, np.ndarray], tmp_path: Path) -> None:
    recipe, device = TrainingRecipe(groups=2, warmup=2), torch.device("cpu")
    straight = Trainer(recipe, bank, device, TINY)
    unseen = straight.student.clip.token_embedding.weight.abs().sum(1) == 0
    before = straight.student.clip.visual.conv1.weight.clone()
    for step in range(4):
        losses = straight.advance()
        assert all(np.isfinite(value) for value in losses.values())
        if step == 1:
            straight.save(tmp_path / "checkpoint.pt")
    resumed = Trainer(recipe, bank, device, TINY)
    resumed.load(tmp_path / "checkpoint.pt")
    resumed.advance()
    resumed.advance()
    assert resumed.step == straight.step == 4
    for name, value in straight.student.state_dict().items():
        assert torch.equal(value, resumed.student.state_dict()[name]), name
    for name, value in straight.average.items():
        assert torch.equal(value, resumed.average[name]), name
    assert not torch.equal(before, straight.student.clip.visual.conv1.weight)
    assert 0.1 < unseen.float().mean() < 0.9
    still = (straight.average["clip.token_embedding.weight"][unseen] == 0).all(1)
    assert still.float().mean() > 0.9  # all but parts of names that nobody knows
    straight.export(tmp_path / "model")
    fresh = Trainer(recipe, bank, device, TINY)
    fresh.start_from(tmp_path / "model")  # checkpoints do not outlive a machine, exported weights do
    shipped = {n: w.half() for n, w in straight.average.items() if n.startswith(("clip.", "heads."))}
    assert all(torch.equal(fresh.student.state_dict()[n].half(), w) for n, w in shipped.items())
    other = Trainer(recipe, bank, device, TINY | {"embed_dim": 16})
    with pytest.raises(VibeError, match="another architecture"):
        other.start_from(tmp_path / "model")
    with pytest.raises(VibeError, match="another architecture or vocabulary"):
        other.load(tmp_path / "checkpoint.pt")
    encoder = load_encoder(str(tmp_path / "model"))
    assert encoder.size == SIZE
    assert heads_of(encoder) is not None
    assert encoder.encode_images(torch.rand(2, 3, SIZE, SIZE)).shape == (2, 32)


@pytest.mark.slow
def test_losses_fall_on_a_batch_that_is_seen_again(bank: dict[str, np.ndarray]) -> None:
    trainer = Trainer(TrainingRecipe(), bank, torch.device("cpu"), TINY)
    batch = make_batch(bank, 3, seed=1)
    history = []
    for _ in range(12):
        losses = trainer.student.losses(batch, trainer.device)
        history.append(torch.stack(list(losses.values())).detach())
        trainer.optimizer.zero_grad()
        sum(losses.values()).backward()
        trainer.optimizer.step()
    assert (history[-1] < 0.9 * history[0]).all(), history


def test_skill_is_what_a_head_knows_beyond_a_blind_guess():
    def judged(heads: dict[str, float], commonest: dict[str, float], count: int = 40) -> dict:
        return {"heads": heads, "commonest": commonest, "comparisons": {f"heads/{name}": count for name in heads}}

    one = judged({"fog": 0.75, "vignette": 0.4}, {"fog": 0.5, "vignette": 0.6})
    sure, uniform = judged({"fog": 1.0}, {"fog": 0.5}), judged({"fog": 0.9}, {"fog": 0.9})
    rare = judged({"fog": 0.5}, {"fog": 0.5}, count=3)
    assert skill([one, sure, uniform, rare]) == {"fog": 0.5, "vignette": 0.0}
