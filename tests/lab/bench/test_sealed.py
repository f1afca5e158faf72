# SPDX-License-Identifier: Apache-2.0
"""`python -m lab sealed`: what is drawn, and its judge, every rule both ways on pictures that are made for it."""

import re
import subprocess

import numpy as np
import pytest
from ball_pictures import DISC, SIDE, X, Y, gray, lit, painted, shot

from lab.bench.sealed import commit, contest, experiment, judge, prompts, rules, table
from lab.bench.sealed.prompts import STRICT, Looseness, SealedAsk
from lab.bench.sealed.scenes import things
from lab.methods import Variation
from proxy_renderer.color.floats import srgb_from_hex
from proxy_renderer.schema import VibeError


def plain(job):
    return job.prompt, job.asks, job.scene


# ---- what is drawn


def test_a_seed_draws_the_same_again_and_another_one_something_else():
    first = [plain(prompts.draw("a", number)) for number in range(20)]
    assert [plain(prompts.draw("a", number)) for number in range(20)] == first
    other = [plain(prompts.draw("b", number)) for number in range(20)]
    assert not {row[0] for row in first} & {row[0] for row in other}


@pytest.fixture(scope="module")
def many():
    return [prompts.draw("many", number) for number in range(600)]


def test_prompts_are_varied_and_say_their_asks(many):
    assert len({job.prompt for job in many}) > 550
    assert {job.scene.thing.shape for job in many} == {thing.shape for thing in things()}
    kinds = {ask.kind for job in many for ask in job.asks}
    assert kinds == {"color", "material", "finish", "time", "weather", "grade", "mood", "light", "lamp"}
    for job in many:
        assert 1 <= len(job.asks) <= 3
        assert "{" not in job.prompt
        assert not re.search(r"\ba [aeiou]", job.prompt)
        assert all(ask.words.lower() in job.prompt.lower() for ask in job.asks)


def test_long_prompts_ask_for_as_much_as_those_of_the_paper(many):
    long = [prompts.draw("many", number, long=True) for number in range(200)]
    assert {len(job.asks) for job in long} == {3, 4, 5}
    assert {ask.kind for job in long for ask in job.asks} == {ask.kind for job in many for ask in job.asks}
    for job in long:
        assert not prompts.clash(job.asks)
        assert all(ask.words.lower() in job.prompt.lower() for ask in job.asks)


def test_every_ask_is_judged_by_something(many):
    assert all(ask.shows or ask.color is not None or ask.material for job in many for ask in job.asks)


def test_no_prompt_contradicts_itself(many):
    assert not any(prompts.clash(job.asks) for job in many)
    bright, night = (SealedAsk("time", word, shows=(word,)) for word in ("bright", "dark"))
    red = SealedAsk("color", "red", "Ball", color=(1.0, 0.0, 0.0))
    gray_photo = SealedAsk("grade", "monochrome", shows=("monochrome",))
    assert prompts.clash([bright, night])
    assert prompts.clash([red, gray_photo])
    assert not prompts.clash([red, night])


def test_the_lists_are_whole():
    names = [name for name, _ in prompts.survey_colors()]
    assert (len(names), len(set(names))) == (949, 949)
    assert dict(prompts.survey_colors())["cloudy blue"] == srgb_from_hex("#acc2d9")
    assert len(prompts.measured()["materials"]) == 110
    assert len({row["say"] for row in prompts.measured()["materials"]}) == 110
    assert len({row["name"].partition(" (")[0] for row in prompts.measured()["lights"]}) == 25


# ---- the commit


def test_the_seed_is_the_commit_and_changes_are_told(tmp_path):
    def git(*arguments):
        own = ["-c", "user.name=a", "-c", "user.email=a@example.org"]
        done = subprocess.run(["git", "-C", tmp_path, *own, *arguments], check=True, capture_output=True, text=True)
        return done.stdout.strip()

    git("init")
    git("commit", "--allow-empty", "-m", "first")
    assert commit.judged_commit(tmp_path) == (git("rev-parse", "HEAD"), False)
    (tmp_path / "new").write_text("x")
    assert commit.judged_commit(tmp_path)[1]


def test_without_a_clone_a_seed_is_asked_for(tmp_path):
    with pytest.raises(VibeError, match="--seed"):
        commit.judged_commit(tmp_path)


def test_a_number_of_jobs_out_of_range_is_refused(tmp_path):
    with pytest.raises(VibeError, match="--jobs 0"):
        experiment.run(tmp_path, jobs=0, drawn_from="a")


# ---- rules

RED, BLUE, WARM, COOL = (painted(*[code] * 2) for code in ("#d02020", "#2040d0", "#c08040", "#4080c0"))
BLACK, DARK, MIDDLE, LIGHT = (shot(gray(level)) for level in (0.0, 0.02, 0.2, 0.6))
STARK = painted("#ffffff", "#000000")
SPLIT, OPPOSITE = (
    shot(np.where((X < 0)[..., None], srgb_from_hex(a), srgb_from_hex(b)))
    for a, b in (("#182838", "#e0a060"), ("#382818", "#a0c0ff"))
)
CORNERS = shot(gray(0.4 * np.clip(1.15 - 0.55 * np.hypot(X, Y) ** 2, 0, 1)))
HARD, SOFT = (shot(gray(0.05 + 0.5 / (1 + np.exp(-(Y + 0.8) / width)))) for width in (0.01, 0.3))
LEFT, RIGHT, ABOVE, BELOW = (lit(*way) for way in ((-1, 0, 0.6), (1, 0, 0.6), (0, 1, 0.6), (0, -1, 0.6)))
FRONT, BEHIND = lit(0, 0, 1), lit(1, 0, -0.5)
_EDGE = DISC & (np.hypot(X, Y) > 0.53)
RIM = shot(gray(np.where(_EDGE, 0.8, 0.1)))
_CLEAR = lit(-1, 1, 1).display
FOG, MIST, AIR = (shot((1 - a) * _CLEAR + a * 0.6, clear=_CLEAR) for a in (0.5, 0.15, 0.0))
MATTE = lit(-1, 1, 1)
_SPOT = MATTE.display.copy()
_SPOT[22:25, 24:27] = 1.0
GLOSSY = shot(_SPOT)

PICTURES = {
    "dark": (DARK, MIDDLE),
    "dim": (DARK, LIGHT),
    "bright": (LIGHT, MIDDLE),
    "high-key": (LIGHT, MIDDLE),
    "warm": (WARM, MIDDLE),
    "cool": (COOL, MIDDLE),
    "not warm": (MIDDLE, WARM),
    "monochrome": (MIDDLE, WARM),
    "sepia": (painted("#70512d", "#b8996f"), COOL),
    "vivid": (RED, MIDDLE),
    "muted": (MIDDLE, RED),
    "contrasty": (STARK, MIDDLE),
    "flat": (MIDDLE, STARK),
    "faded blacks": (MIDDLE, STARK),
    "deep blacks": (STARK, MIDDLE),
    "vignetted": (CORNERS, MIDDLE),
    "cold shadows": (SPLIT, OPPOSITE),
    "warm lights": (SPLIT, OPPOSITE),
    "soft": (SOFT, HARD),
    "hard": (HARD, SOFT),
    "from the left": (LEFT, RIGHT),
    "from the right": (RIGHT, LEFT),
    "from above": (ABOVE, BELOW),
    "from below": (BELOW, ABOVE),
    "from the front": (FRONT, BEHIND),
    "from behind": (BEHIND, FRONT),
    "rimmed": (RIM, MIDDLE),
    "foggy": (FOG, MIST),
    "misty": (MIST, AIR),
    "clear": (AIR, FOG),
    "glossy": (GLOSSY, MATTE),
    "matte": (MATTE, GLOSSY),
}
VALUES = {
    "polished": (0.1, 0.5),
    "rough": (0.8, 0.3),
    "satin": (0.4, 0.1),
    "metallic": (1.0, 0.0),
    "not metallic": (0.0, 1.0),
    "see-through": (1.0, 0.0),
    "lacquered": (0.9, 0.0),
    "fuzzy": (0.8, 0.0),
    "glowing": (2.0, 0.0),
}


def values(**given):
    return {f"material/Ball/{name}": {"after": value} for name, value in given.items()}


def holds(ask, after, before=MIDDLE, loose=STRICT, **given):
    found = judge.findings(ask, judge.Evidence(before, after, values(**given)), loose)
    assert found
    return all(each.holds for each in found)


def test_every_rule_is_tried():
    assert {*PICTURES, *VALUES} == set(rules.rules())


@pytest.mark.parametrize("name", PICTURES)
def test_a_rule_holds_on_a_picture_that_shows_it_and_not_on_one_that_does_not(name):
    good, bad = PICTURES[name]
    ask = SealedAsk("mood", name, "Ball", (name,))
    assert holds(ask, good, before=bad)
    assert not holds(ask, bad, before=bad)
    assert not holds(ask, bad, before=good)


@pytest.mark.parametrize("name", VALUES)
def test_a_rule_of_values_reads_the_things_own(name):
    good, bad = VALUES[name]
    ask, parameter = SealedAsk("finish", name, "Ball", (name,)), rules.rule(name).value
    assert holds(ask, MIDDLE, **{parameter: good})
    assert not holds(ask, MIDDLE, **{parameter: bad})
    assert not holds(ask, MIDDLE)


# ---- colors, lamps and materials


@pytest.mark.parametrize(
    ("shown", "asked", "right"),
    [
        ("#2f6b45", "#1e7a46", True),
        ("#c0392b", "#1e7a46", False),  # another hue
        ("#8ad6a8", "#1e5a36", False),  # much lighter
        ("#59615c", "#1e7a46", False),  # too gray
        ("#d8d8d4", "#e4e4e4", True),
        ("#d8b8a0", "#e4e4e4", False),  # no gray
    ],
)
def test_a_color_is_judged_by_hue_lightness_and_chroma(shown, asked, right):
    ask = SealedAsk("color", "a color", "Ball", color=srgb_from_hex(asked))
    assert holds(ask, painted(shown, "#1e7a46")) == right


def test_a_color_under_colored_light_has_more_room():
    green = SealedAsk("color", "green", "Ball", color=srgb_from_hex("#1e9a46"))
    yellowish, darker = painted("#6b7c30", "#ffffff"), painted("#0a3c16", "#ffffff")
    assert not holds(green, yellowish)
    assert holds(green, yellowish, loose=Looseness(tint=True, lightness=False))
    assert not holds(green, darker, loose=Looseness(tint=True, lightness=False))
    assert holds(green, darker, loose=Looseness(tint=False, lightness=True))


def test_a_colored_lamp_tints_the_picture():
    lamp = SealedAsk("lamp", "glow stick", color=(0.0, 1.0, 0.0))
    assert holds(lamp, painted("#308038", "#40a048"))
    assert not holds(lamp, painted("#803038", "#a04048"))
    assert not holds(lamp, MIDDLE)


def measured(say):
    row = next(row for row in prompts.measured()["materials"] if row["say"] == say)
    return SealedAsk("material", say, "Ball", material=row)


def test_a_metal_has_its_tint_and_is_metallic():
    golden, pink = painted("#d8a850", "#808080"), painted("#d080b0", "#808080")
    assert holds(measured("gold"), golden, metallic=1.0)
    assert not holds(measured("gold"), golden, metallic=0.0)
    assert not holds(measured("gold"), pink, metallic=1.0)


def test_what_is_no_metal_has_its_color_and_its_roughness():
    clay = painted("#c07a5c", "#808080")
    assert holds(measured("terracotta"), clay, metallic=0.0, roughness=0.7)
    assert not holds(measured("terracotta"), clay, metallic=0.0, roughness=0.1)
    assert not holds(measured("terracotta"), clay, metallic=1.0, roughness=0.7)
    assert not holds(measured("terracotta"), painted("#5c7ac0", "#808080"), metallic=0.0, roughness=0.7)


def test_what_is_clear_lets_light_through():
    assert holds(measured("diamond"), MIDDLE, metallic=0.0, transmission=1.0)
    assert not holds(measured("diamond"), MIDDLE, metallic=0.0, transmission=0.0)


# ---- jobs and figures


def job(*asks):
    return prompts.SealedJob(0, "a prompt", asks, prompts.draw("a", 0).scene)


def test_what_is_hardly_in_view_is_not_judged():
    red = SealedAsk("color", "red", "Ball", color=(0.8, 0.1, 0.1))
    left = SealedAsk("light", "left", shows=("from the left",))
    none = shot(RED.display)
    gone = type(none)(none.display, np.zeros((SIDE, SIDE)), none.normal, np.ones((SIDE, SIDE), int), none.materials)
    evidence = judge.Evidence(gone, gone, {})
    assert [holds for _, holds, _ in judge.judged(job(red, left), evidence)] == [None, None]
    assert [holds for _, holds, _ in judge.judged(job(red), judge.Evidence(RED, RED, {}))] == [True]


def test_a_hidden_subject_is_not_seen():
    assert judge.Evidence(MATTE, painted("#a06040", "#404850"), {}).subject_is_seen is False  # no detail in it
    assert judge.Evidence(MATTE, MATTE, {}).subject_is_seen
    assert judge.Evidence(MATTE, BLACK, {}).subject_is_seen is False


def row(held, seen=True, kind="color", **more):
    asks = [
        {"kind": kind, "words": "red", "part": "Ball", "new_color": kind == "color", "holds": each, "found": []}
        for each in held
    ]
    done = {"prompt": "p", "code": 0, "error": "", "seconds": 9.0, "asks": asks, "seen": seen, "asked": len(asks)}
    return {**done, "claims": 2, "claims_held": 1, "ignored": ["x"], **more}


def test_the_summary_counts_asks_prompts_and_failures():
    failed = {"prompt": "f", "code": 2, "error": "vibe: no.", "seconds": 1.0, "asked": 2}
    results = table.summary([row([True, False]), row([True], seen=False, kind="mood"), row([None]), failed])
    assert (results["asks"]["held"], results["asks"]["asked"]) == (2, 5)
    assert results["asks_seen"]["held"] == 1
    assert results["kinds"]["color"]["share"] == results["new_colors"]["share"] == 0.5
    assert (results["prompts"]["held"], results["prompts"]["asked"]) == (1, 3)
    assert (results["claims"]["held"], results["claims"]["asked"]) == (3, 6)
    assert (results["unjudged"], results["words_ignored"]) == (1, 3)
    assert results["failed"] == {"f": "vibe: no."}
    assert 0.1 < results["asks"]["interval"][0] < 0.4 < results["asks"]["interval"][1] < 0.8
    table.show(results)


# ---- the contest


def test_the_one_that_shows_more_wins_and_a_tie_is_half_a_win():
    failed = {"prompt": "f", "code": 2, "error": "vibe: no.", "seconds": 1.0, "asked": 2}
    better, worse, even = ((row([True, True]), row([True, None])), (row([False]), row([True])), (row([None]), failed))
    hidden = (row([True, True], seen=False), row([True, False]))
    figures = contest.summary(*zip(better, worse, even, hidden, strict=True))
    assert [figures["wins"][kind] for kind in ("win", "tie", "loss")] == [2, 1, 1]
    assert figures["wins"]["win_rate"] == 0.625
    assert 0.2 < figures["wins"]["interval"][0] < 0.3
    assert [figures["wins_seen"][kind] for kind in ("win", "tie", "loss")] == [1, 1, 2]
    assert (figures["asks"]["held"], figures["asks"]["asked"]) == (3, 6)
    contest.show("clip-only", figures)


@pytest.mark.parametrize(("loop", "asked"), [(2.0, [12]), (20.0, [12, 106, 164])])
def test_a_baseline_has_as_many_seconds_as_the_product(loop, asked):
    """A stand-in for runs: one second for anything, and eight steps a second."""
    steps = []

    def carry_out(variation):
        steps.append(int(variation.options[-1].partition("=")[2]))
        return row([True], loop_seconds=1 + steps[-1] / 8)

    last = contest.rival_row("clip-only", 10, row([True], loop_seconds=loop), carry_out)
    assert steps[: len(asked)] == asked
    assert last["loop_seconds"] >= loop


def test_the_plan_alone_is_a_rival_without_steps():
    asked = []
    contest.rival_row("projection", 0, row([True], loop_seconds=9.0), lambda told: asked.append(told) or row([True]))
    assert asked == [Variation("projection")]


def test_a_baseline_that_fails_is_not_tried_for_ever():
    failed = {"prompt": "f", "code": 2, "error": "vibe: no.", "seconds": 1.0, "asked": 2}
    assert contest.rival_row("clip-only", 10, row([True], loop_seconds=20.0), lambda _: failed) == failed


def test_a_contest_puts_both_before_the_same_judge(tmp_path, monkeypatch, capsys):
    """A stand-in for runs: the product shows all, the baseline nothing."""

    def vibed(trial):
        return row([not trial.variation.method] * len(trial.job.asks), loop_seconds=9.0)

    monkeypatch.setattr(experiment.SealedTrial, "row", vibed)
    results = experiment.run(tmp_path, jobs=3, drawn_from="a", rival="clip-authors")
    assert results["contest"]["wins"]["win"] == 3
    assert results["asks"]["share"] == 1.0
    assert len({each["run"] for each in [*results["rows"], *results["contest"]["rows"]]}) == 6
    assert "Wins against clip-authors by asks: 100%" in capsys.readouterr().out
