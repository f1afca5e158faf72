# SPDX-License-Identifier: Apache-2.0
"""Which wild scenes are tried, with what words, and what counts as an outcome."""

from pathlib import Path

import pytest

from lab.bench.wild import corpus, table
from proxy_renderer.schema import VibeError

DONE = {"code": 0, "black": False, "error": "", "seconds": 10.0, "memory_gb": 1.0, "left_behind": [], "p95": 2.0}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("a/car.blend", "a/car.blend1", "b/cup.GLB", "readme.txt"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(b"x")
    return tmp_path


def test_scenes_of_all_folders_are_found(folder: Path) -> None:
    assert corpus.names(folder) == ["a/car.blend", "b/cup.GLB"]
    assert corpus.names(folder, "*car*") == ["a/car.blend"]


def test_a_list_chooses_and_must_be_there(folder: Path) -> None:
    listed = folder / "list.txt"
    listed.write_text("# mine\n\nb/cup.GLB  # a cup\n")
    assert corpus.names(folder, listed=str(listed)) == ["b/cup.GLB"]
    listed.write_text("c/gone.blend\n")
    with pytest.raises(VibeError, match=r"c/gone.blend is not below"):
        corpus.names(folder, listed=str(listed))


def test_nothing_to_try_is_said(folder: Path) -> None:
    with pytest.raises(VibeError, match="No scene"):
        corpus.names(folder, "*.fbx")
    with pytest.raises(VibeError, match="There is no folder"):
        corpus.names(folder / "nowhere")


def test_names_alone_say_the_half_and_the_words() -> None:
    names = [f"OWNER+NAME/{number}.blend" for number in range(400)]
    halves = [corpus.half_of(name) for name in names]
    assert set(halves) == {"development", "held-out"}
    assert 150 < halves.count("held-out") < 250
    assert {corpus.prompt_of(name) for name in names} == set(corpus.PROMPTS)


@pytest.mark.parametrize(
    ("row", "outcome"),
    [
        (DONE, "picture"),
        ({**DONE, "black": True}, "broken"),
        ({**DONE, "code": 2, "error": "vibe: There is no mesh. Add one."}, "refused"),
        ({**DONE, "code": 1, "error": "vibe: Something unexpected happened; the log says more."}, "broken"),
        ({**DONE, "code": -9, "error": "nothing was said"}, "broken"),
    ],
)
def test_an_outcome_is_a_picture_a_clear_line_or_broken(row: dict, outcome: str) -> None:
    assert table.outcome(row) == outcome


def test_the_summary_counts_and_takes_percentiles() -> None:
    rows = {str(i): {**DONE, "delta_e": i / 10, "revert": {"differ": i // 9}} for i in range(10)}
    rows["x"] = {**DONE, "code": 1, "error": "nothing was said", "left_behind": ["cache"]}
    summary = table.summary(rows)
    assert (summary["scenes"], summary["pictures"], summary["refused"]) == (11, 10, 0)
    assert summary["failed"] == ["x"]
    assert (summary["exact_reverts"], summary["compared_reverts"], summary["clean"]) == (9, 10, 10)
    assert summary["delta_e"] == {"median": 0.45, "p90": 0.9}
