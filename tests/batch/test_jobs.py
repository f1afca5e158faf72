# SPDX-License-Identifier: Apache-2.0
"""Batches of simulated jobs: nothing is lost, nothing is done twice, nothing stands in the way of the rest."""

import csv
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest
from batch_parts import carry_out, contents, plan_of

from proxy_renderer.batch.manifest import BatchPlan, Limits, SceneGroup, Take
from proxy_renderer.batch.pools import fitting, machine
from proxy_renderer.batch.store import Finals, Store, takes
from proxy_renderer.schema import VibeError

QUICK = {"free_gb": 0.0, "retries": 0}
ROOT = Path(__file__).parents[2]


def process_of(folder, job):
    """The number of the process that carried out a job."""
    log = (folder / "jobs" / job["name"] / "log.txt").read_text()
    return log.rpartition("as process ")[2].split('"')[0]


def test_one_warm_process_does_all_jobs(tmp_path):
    told, rows = carry_out(tmp_path, plan_of("noir", "misty", "neon"))
    assert [row["status"] for row in rows] == ["done"] * 3
    assert len({process_of(tmp_path, row) for row in rows}) == 1
    assert told == [(what, p) for p in ("noir", "misty", "neon") for what in ("started", "done")]


def shot(scene, camera="", frame=None, blend="vibed.blend"):
    return {"scene": scene, "camera": camera, "frame": frame, "blend": blend}


@pytest.mark.parametrize(
    ("shots", "wanted", "expected"),
    [
        ([], "", [Take(0)]),
        ([shot("a", "Wide", 1), shot("a", "Wide", 50)], "", [Take(0, "Wide", "1,50")]),
        (
            [shot("a", "Wide"), shot("a", "Close"), shot("b", "Wide", blend="vibed-2.blend")],
            "1-24",
            [Take(0, "Wide", "1-24", "a-Wide"), Take(0, "Close", "1-24", "a-Close"), Take(1, "Wide", "1-24", "b-Wide")],
        ),
        (  # a grade for each frame
            [shot("a", frame=1), shot("a", frame=50, blend="vibed-2.blend")],
            "",
            [Take(0, "", "1", "1"), Take(1, "", "50", "50")],
        ),
        ([shot("a", "A/B: ../x"), shot("a", "B")], "", [Take(0, "A/B: ../x", "", "A_B_.._x"), Take(0, "B", "", "B")]),
    ],
)
def test_final_frames_are_those_of_the_shots(shots, wanted, expected):
    """Each .blend through each camera, at the frames that are asked for, else at those of the look."""
    blends = list(dict.fromkeys(each["blend"] for each in shots))
    assert list(takes(shots, blends, wanted)) == expected


def test_final_frames_of_shots_that_share_a_look(tmp_path):
    plan = BatchPlan([SceneGroup("kitchen", Path("a.blend"), "digest", ("noir",), (0,), ("--cameras=Wide,Close",))])
    limits = Limits(free_gb=0.0, retries=0)
    carry_out(tmp_path, plan, limits)
    with Store(tmp_path) as store:
        finals = Finals(plan, store, "1-2")
    carry_out(tmp_path, finals, limits)
    (frames,) = tmp_path.glob("jobs/*/frames")
    found = {p.relative_to(frames).as_posix(): p.read_text() for p in frames.rglob("*.png")}
    assert found == {f"{camera}/000{number}.png": camera for camera in ("Wide", "Close") for number in (1, 2)}
    (row,) = json.loads(f"[{(tmp_path / 'results.jsonl').read_text()}]")
    assert row["status"] == "done"


def test_a_second_run_has_nothing_to_do(tmp_path):
    plan = plan_of("noir", "misty", seeds=(0, 1))
    carry_out(tmp_path, plan)
    before = {p: p.stat().st_mtime_ns for p in tmp_path.glob("jobs/*/*")}
    told, rows = carry_out(tmp_path, plan)
    assert not told
    assert len(rows) == 4
    assert {p: p.stat().st_mtime_ns for p in tmp_path.glob("jobs/*/*")} == before


def test_failures_are_recorded_tried_again_and_never_block(tmp_path):
    prompts = ("fails", "crash", "lucky once", "noir")
    told, rows = carry_out(tmp_path, plan_of(*prompts), Limits(free_gb=0.0, retries=1))
    said = {row["prompt"]: row for row in rows}
    assert [said[p]["status"] for p in prompts] == ["failed", "failed", "done", "done"]
    assert said["fails"]["error"] == "The camera is panoramic."
    assert "Segmentation fault" in said["crash"]["error"]
    assert said["fails"]["attempts"] == said["crash"]["attempts"] == 2
    assert told.index(("done", "noir")) < told.index(("failed", "fails"))  # again means: after all others
    log = (tmp_path / said["crash"]["folder"] / "log.txt").read_text()
    assert len(set(re.findall(r"as process (\d+)", log))) == 2  # a fresh one after a crash


def test_the_next_run_tries_failed_jobs_again(tmp_path):
    limits = Limits(**QUICK)
    assert [r["status"] for r in carry_out(tmp_path, plan_of("lucky once"), limits)[1]] == ["failed"]
    assert [r["status"] for r in carry_out(tmp_path, plan_of("lucky once"), limits)[1]] == ["done"]


@pytest.mark.parametrize(
    ("prompt", "limit", "said"),
    [("sleeps", {"minutes": 0.02}, "longer than 0.02 minutes"), ("eats", {"memory_gb": 0.3}, "more than 0.3")],
)
def test_a_job_over_its_limit_is_ended_with_its_children_and_the_next_one_goes_on(tmp_path, prompt, limit, said):
    _, rows = carry_out(tmp_path, plan_of(prompt, "noir"), Limits(**QUICK, **limit))
    assert [row["status"] for row in rows] == ["failed", "done"]
    assert said in rows[0]["error"]
    assert rows[0]["remedy"]
    assert not psutil.pid_exists(int(process_of(tmp_path, rows[0])))


def test_several_workers_share_the_jobs(tmp_path):
    _, rows = carry_out(tmp_path, plan_of("slow", seeds=range(6)), workers=3)
    assert [row["status"] for row in rows] == ["done"] * 6
    assert len({process_of(tmp_path, row) for row in rows}) == 3


def test_what_is_killed_is_resumed_with_the_same_results(tmp_path):
    prompts = [f"slow {n}" for n in range(6)]
    whole, _ = carry_out(tmp_path / "whole", plan_of(*prompts))
    program = [sys.executable, str(ROOT / "tests" / "batch_parts.py"), str(tmp_path / "cut"), *prompts]
    process = subprocess.Popen(program, env={**os.environ, "PYTHONPATH": str(ROOT)})
    deadline = time.monotonic() + 60
    while len(list(tmp_path.glob("cut/jobs/*/done.json"))) < 2:
        assert time.monotonic() < deadline
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    told, rows = carry_out(tmp_path / "cut", plan_of(*prompts))
    assert 2 <= len(whole) - len(told) < len(whole)
    assert [row["status"] for row in rows] == ["done"] * 6
    assert contents(tmp_path / "cut") == contents(tmp_path / "whole")


def test_a_moved_folder_resumes(tmp_path):
    carry_out(tmp_path / "here", plan_of("noir", "misty"))
    shutil.move(tmp_path / "here", tmp_path / "there")
    told, rows = carry_out(tmp_path / "there", plan_of("noir", "misty", "neon"))
    assert told == [("started", "neon"), ("done", "neon")]
    assert not any(str(tmp_path) in (tmp_path / "there" / n).read_text() for n in ("index.html", "results.csv"))
    assert len(rows) == 3


def test_two_batches_in_one_folder_are_refused(tmp_path):
    with Store(tmp_path), pytest.raises(VibeError, match=rf"Another batch .*process {os.getpid()}"), Store(tmp_path):
        pass
    with Store(tmp_path):
        pass


def test_nothing_starts_without_disk_space(tmp_path):
    with pytest.raises(VibeError, match=r"GB are free in .* less than 1e\+06"):
        carry_out(tmp_path, plan_of("noir"), Limits(free_gb=1e6))
    assert not list(tmp_path.glob("jobs/*"))


def test_a_full_disk_stops_the_batch_in_one_line_and_it_resumes(tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", str(disk)]
    if not shutil.which("mount") or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("a small disk cannot be mounted here (no right to)")
    try:
        plan = plan_of(*(f"noir {n}" for n in range(30)))
        with pytest.raises(VibeError, match=r"cannot be written: no space is left|holds no report"):
            carry_out(disk, plan, Limits(**QUICK))
        done = len(list(disk.glob("jobs/*/done.json")))
        assert 0 < done < 30
        subprocess.run(["mount", "-o", "remount,size=8m", str(disk)], check=True)
        _, rows = carry_out(disk, plan, Limits(**QUICK))
        assert [row["status"] for row in rows] == ["done"] * 30
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_the_tables_have_a_row_for_each_job(tmp_path):
    _, rows = carry_out(tmp_path, plan_of("noir", "fails"), Limits(**QUICK))
    lines = [json.loads(line) for line in (tmp_path / "results.jsonl").read_text().splitlines()]
    with (tmp_path / "results.csv").open(newline="") as file:
        cells = list(csv.DictReader(file))
    assert [r["status"] for r in lines] == [r["status"] for r in cells] == ["done", "failed"]
    assert (lines[0]["visible"], lines[0]["missed"], lines[0]["already"]) == (["misty"], ["noir"], [])
    assert (cells[0]["visible"], cells[1]["visible"]) == ("misty", "")
    assert lines[0]["delta_e"] == 0.5
    assert all((tmp_path / lines[0][kind]).is_file() for kind in ("before", "after", "blend", "preset", "report"))
    assert cells[1]["error"] == rows[1]["error"]


def test_workers_fit_cores_and_memory_and_cards():
    small = Limits(cores=2, memory_gb=8.0)
    assert fitting({"CPU": 16, "memory": 33e9}, small) == 4
    assert fitting({"CPU": 7, "memory": 33e9}, small) == 3
    assert fitting({"CPU": 64, "memory": 640e9, "GPU": 2}, small) == 8
    assert fitting({"CPU": 1, "memory": 33e9}, small) == 0
    assert machine()["CPU"] == len(os.sched_getaffinity(0))
