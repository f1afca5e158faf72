# SPDX-License-Identifier: Apache-2.0
"""`python -m lab paper`: its measures on pictures that are made for them, its rule, its runs and its page."""

from dataclasses import replace

import numpy as np
import pytest
from ball_pictures import DISC, NORMAL, SIDE, X, Y, gray, lit, painted, shot
from model_server import MODEL, says, serving
from PIL import Image

from lab.bench.paper import experiment, measures, page, pairs, runs, verdict
from lab.bench.paper.runs import RunBudget
from lab.bench.paper.visible import SubjectVisibility, visibility
from proxy_renderer.color.floats import lab_from_srgb, srgb_from_hex
from proxy_renderer.schema import VibeError
from proxy_renderer.vlm import judge

WHOLE = SubjectVisibility(1.0, 1.0, 1.0)


# ---- measures


def test_a_color_is_measured_where_it_is_asked_for():
    picture = painted("#008080", "#ffffff")
    teal, white = lab_from_srgb(srgb_from_hex("#008080")), lab_from_srgb((1, 1, 1))
    assert measures.color_error(picture, "subject", teal) == pytest.approx(0, abs=0.01)
    assert measures.color_error(picture, "Wall", white) == pytest.approx(0, abs=0.01)
    assert (
        min(measures.color_error(picture, "surroundings", teal), measures.color_error(picture, "subject", white)) > 25
    )


def test_a_highlight_does_not_change_a_color_and_lightness_counts_half():
    display = painted("#c02020", "#808080").display
    display[20:24, 24:28] = 1.0
    assert measures.color_error(shot(display), "subject", lab_from_srgb(srgb_from_hex("#c02020"))) < 0.1
    gray_error = measures.color_error(painted("#777777", "#000000"), "subject", (60.0, 0.0, 0.0))
    full = measures.ciede2000(
        *(
            measures.torch.tensor(c, dtype=measures.torch.float64)
            for c in (lab_from_srgb(srgb_from_hex("#777777")), (60.0, 0.0, 0.0))
        )
    )
    assert gray_error == pytest.approx(0.5 * float(full), rel=0.02)


def test_gloss_is_the_contrast_of_small_highlights():
    shaded = lit(-1, 1, 1)
    sharp, dull = shaded.display.copy(), shaded.display.copy()
    sharp[22:25, 24:27] = 1.0
    dull += 0.06 * np.exp(-((X + 0.2) ** 2 + (Y - 0.25) ** 2) / 0.15)[..., None]
    found = [measures.taken("gloss", shot(d), "subject") for d in (shaded.display, dull, sharp)]
    assert found[0] + 10 < found[2]
    assert found[1] < found[0] + 4


def test_fog_is_measured_against_the_same_picture_without_it():
    clear = lit(-1, 1, 1).display
    veiled = 0.5 * clear + 0.3
    assert measures.fog(shot(veiled, clear=clear), "picture") > 0.3
    assert measures.fog(shot(clear, clear=clear), "picture") == pytest.approx(0)
    assert measures.fog(shot(veiled), "picture") == 0  # a flat grade


def test_a_vignette_darkens_all_corners_and_a_lamp_from_the_side_does_not():
    radius = np.hypot(X, Y)
    assert measures.taken("vignette", shot(gray(0.4 * np.clip(1.15 - 0.55 * radius**2, 0, 1))), "picture") > 9
    assert measures.taken("vignette", shot(gray(0.25 + 0.2 * X)), "picture") < 1


@pytest.mark.parametrize(
    ("lamp", "right", "up"), [((-1, 0, 0.6), -0.8, 0), ((1, 0, 0.6), 0.8, 0), ((0, 1, 0.6), 0, 0.8)]
)
def test_the_side_of_the_light_is_read_off_the_shading(lamp, right, up):
    picture = lit(*lamp)
    assert measures.taken("light_right", picture, "subject") == pytest.approx(right, abs=0.2)
    assert measures.taken("light_up", picture, "subject") == pytest.approx(up, abs=0.2)


def test_even_light_has_no_side():
    assert abs(measures.taken("light_right", shot(gray(0.3)), "subject")) < 0.05


def test_hard_shadows_have_steep_edges():
    steps = [shot(gray(0.1 + 0.4 / (1 + np.exp(-(Y + 0.8) / width)))) for width in (0.01, 0.2)]
    hard, soft = (measures.taken("hardness", s, "surroundings") for s in steps)
    assert hard > 3 * soft > 0


def test_tone_is_measured():
    warm, cool = painted("#c08040", "#c08040"), painted("#4080c0", "#4080c0")
    assert measures.taken("warmth", warm, "picture") > 30 > -20 > measures.taken("warmth", cool, "picture")
    assert measures.taken("chroma", warm, "picture") > 40 > 1 > measures.taken("chroma", shot(gray(0.3)), "picture")
    assert (
        measures.taken("brown_distance", painted("#70512d", "#b8996f"), "picture")
        < 6
        < measures.taken("brown_distance", cool, "picture")
    )
    assert measures.taken("contrast", painted("#ffffff", "#000000"), "picture") == pytest.approx(100, abs=0.1)
    assert measures.taken("standing_out", painted("#ffffff", "#202020"), "subject") > 80
    dark, pale = painted("#101010", "#d0d0d0"), painted("#d0d0d0", "#101010")
    assert measures.taken("silhouette", dark, "subject") > 60 > 0 > measures.taken("silhouette", pale, "subject")


# ---- what can be seen


def test_a_subject_of_the_color_of_its_surroundings_cannot_be_seen():
    good, before = painted("#a06040", "#404850"), lit(-1, 1, 1)
    assert visibility(good, before, silhouette=True).outline > 0.95
    assert visibility(painted("#444444", "#434343"), before, silhouette=True).whole == 0
    assert visibility(painted("#000000", "#d0d0d0"), before, silhouette=False).whole < 0.3


def test_a_subject_that_fills_the_frame_is_not_whole():
    before = lit(-1, 1, 1)
    near = replace(before, mask=(np.hypot(X, Y) < 1.1).astype(float))
    assert visibility(near, before, silhouette=False).frame < 0.5
    away = replace(before, mask=(np.hypot(X, Y) < 0.15).astype(float))
    assert visibility(away, before, silhouette=False).frame < 0.5


# ---- the rule


def pair(*asks):
    return pairs.Pair("test", pairs.WIDER, "a prompt", tuple(map(pairs.read_ask, asks)), set="duck")


def reading(*amounts, visible=WHOLE, judge=None):
    return verdict.Reading(amounts, visible, judge)


def test_a_difference_that_nobody_notices_is_none():
    asked = pair("subject: glossy")
    ours, theirs = verdict.compare(asked, reading(9.0), reading(8.0))
    assert ours == theirs
    ours, theirs = verdict.compare(asked, reading(12.0), reading(6.0))
    assert ours.whole > theirs.whole + 0.3


def test_attributes_of_what_cannot_be_seen_count_nothing():
    asked = pair("subject: black", "picture: dark")
    hidden = reading(0.0, 5.0, visible=SubjectVisibility(0.0, 0.25, 1.0))
    plain = reading(25.0, 50.0)
    ours, theirs = verdict.compare(asked, hidden, plain)
    assert ours.whole == 0 < theirs.whole
    assert ours.mean > theirs.mean


@pytest.mark.parametrize("mask", [np.zeros((SIDE, SIDE)), np.ones((SIDE, SIDE))])
def test_a_subject_that_has_left_or_fills_the_picture_scores_nothing(mask):
    asked = pair("subject: red", "subject: silhouetted", "picture: vignetted", "picture: misty", "Ball: glossy")
    before = lit(-1, 1, 1)
    gone = replace(painted("#ff0000", "#ff0000"), mask=mask)
    assert verdict.alone(asked, verdict.read(asked, gone, before)).whole == 0


def test_the_judge_is_one_ask_among_them():
    asked = pair("subject: glossy")
    ours, _ = verdict.compare(asked, reading(20.0, judge=0.3), reading(20.0, judge=0.0))
    alone, _ = verdict.compare(asked, reading(20.0), reading(20.0))
    assert (ours.whole, alone.whole) == (pytest.approx(1.0), pytest.approx(1.0))
    _, theirs = verdict.compare(asked, reading(20.0, judge=0.3), reading(20.0, judge=0.0))
    assert theirs.whole == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("ours", "theirs", "said"),
    [([0.8, 0.7], [0.5, 0.7], "win"), ([0.5], [0.52], "tie"), ([0.9, 0.1, 0.1], [0.5, 0.5, 0.5], "loss")],
)
def test_seeds_are_averaged(ours, theirs, said):
    assert verdict.decide(ours, theirs) == said


def test_the_interval_is_wilsons():
    assert verdict.wilson(8, 10) == pytest.approx((0.4902, 0.9433), abs=1e-3)
    assert verdict.wilson(0, 0) == (0.0, 1.0)


# ---- pairs and runs


def test_the_pairs_are_the_papers_and_thirty_of_our_own():
    known = pairs.read_pairs()
    groups = [p.group for p in known]
    assert (groups.count("benchmark"), groups.count("concrete_vs_abstract"), groups.count("prompt_extension")) == (
        3,
        2,
        3,
    )
    assert groups.count(pairs.WIDER) >= 24
    assert len({p.name for p in known}) == len(known)
    assert all(p.asks and bool(p.set) != bool(p.mesh) for p in known)


def test_a_pattern_without_pairs_and_an_ask_without_meaning_are_refused():
    with pytest.raises(VibeError, match="No pair"):
        pairs.read_pairs("nothing*")
    with pytest.raises(VibeError, match="neither a trait nor a color"):
        pairs.read_ask("subject: quux")


def test_a_run_is_kept_under_all_that_it_depends_on(tmp_path):
    asked = pair("subject: glossy")

    def folders(pair, budget):
        return [r.folder.name for r in runs.plan([pair], budget, tmp_path, None)]

    first = folders(asked, RunBudget(seeds=2))
    assert len(set(first)) == 4
    assert folders(asked, RunBudget(seeds=2)) == first
    for other in (replace(asked, prompt="another"), replace(asked, set="car")):
        assert not set(folders(other, RunBudget(seeds=2))) & set(first)
    assert not set(folders(asked, RunBudget(seeds=2, steps=3))) & set(first)
    assert folders(replace(asked, asks=()), RunBudget(seeds=2)) == first  # what is measured may change


def finished(run, subject):
    """Puts what a run writes into its folder."""
    run.folder.mkdir(parents=True)
    after = painted(subject, "#dddddd")
    for name, display in (("before", lit(-1, 1, 1).display), ("after", after.display)):
        Image.fromarray((display * 255).astype(np.uint8)).save(run.folder / f"{name}.png")
        sight = {"normal": NORMAL, "material": after.material, "materials": np.array(after.materials)}
        np.savez(run.folder / f"{name}.npz", **sight)
    for name in ("mask", "mask_before"):
        Image.fromarray((DISC * 255).astype(np.uint8)).save(run.folder / f"{name}.png")


def test_a_half_done_experiment_is_summed_up_and_shown(tmp_path, monkeypatch):
    monkeypatch.delenv("VIBE_VLM_MODEL", raising=False)
    monkeypatch.setattr(experiment.judge, "find", lambda: None)
    known = [
        replace(pair("subject: red", "surroundings: #dddddd"), name=n, prompt=f"{n} & <b>red</b>")
        for n in ("one", "two")
    ]
    budget = RunBudget(seeds=1)
    planned = runs.plan(known, budget, tmp_path, None)
    for run in planned[:3]:  # the second pair lacks its baseline
        finished(run, "#777777" if run.variation.method else "#e50000")
    results = experiment.summary(planned, budget)
    assert (results["win"], results["tie"], results["loss"], results["pairs"]) == (1, 0, 0, 1)
    assert results["win_rate"] == 1.0
    row, blind = results["by_pair"]["one"], results["without_visibility"]
    assert (blind["win"], blind["win_rate"]) == (1, 1.0)
    assert row["without_visibility"]["clip_only"] > row["clip_only"]  # gray before gray is hardly seen
    text = page.render(results, planned, tmp_path)
    assert text.count("data:image/jpeg;base64,") == 3
    assert "one &amp; &lt;b&gt;red&lt;/b&gt;" in text
    assert "http" not in text
    assert "<b>red</b>" not in text


def test_a_model_is_asked_by_the_papers_prompt(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    known = [replace(pair("subject: red"), name=n, group="benchmark") for n in judge.PAPER]
    planned = runs.plan([replace(p, prompt=p.name) for p in known], RunBudget(seeds=1), tmp_path, None)
    for run in planned:
        finished(run, "#777777" if run.variation.method else "#e50000")
    words = [says("WINNER = OURS\nREASON = Red."), says("WINNER = TIE\nREASON = Even."), (401, {}, {})]
    with serving(lambda body, n: words[min(n - 1, 2)]) as model:
        monkeypatch.setenv("VIBE_VLM_MODEL", MODEL)
        monkeypatch.setenv("VIBE_VLM_URL", model.url)
        monkeypatch.setenv("VIBE_VLM_TIMEOUT", "3")
        results = experiment.summary(planned, RunBudget(seeds=1))
    assert model.asked[0]["messages"][0]["content"] == judge.INSTRUCTIONS
    said = results["judge"]
    assert said["figure"] == {"winner": "OURS", "reason": "Red."}
    assert said["pairs"]["Dolphin"]["winner"] == "TIE"
    assert "error" in said["pairs"]["Tree"]
    assert (said["win"], said["tie"], said["loss"]) == (0, 1, 0)
    assert "Red." in page.render(results, planned, tmp_path)
    experiment._print(results)
