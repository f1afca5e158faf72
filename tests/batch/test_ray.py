# SPDX-License-Identifier: Apache-2.0
"""Batches of simulated jobs on a real Ray cluster of several nodes on this machine, of which one dies, then the head."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from batch_parts import COMMAND, SMALL, carry_out, contents, on_cluster, plan_of

from proxy_renderer.batch import command
from proxy_renderer.batch.manifest import BatchPlan, SceneGroup
from proxy_renderer.batch.store import Store
from proxy_renderer.batch.worker import Setup

ray = pytest.importorskip("ray", reason="Ray is not installed")
pytestmark = pytest.mark.slow
PROMPTS = [f"slow {n}" for n in range(10)]
NODE = {"num_cpus": 2, "memory": 10**9, "object_store_memory": 80_000_000}
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def cluster():
    """A head without workers, and a node with room for two."""
    monkeypatch = pytest.MonkeyPatch()
    from ray.cluster_utils import Cluster

    paths = [str(ROOT), str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(paths))
    monkeypatch.setenv("RAY_worker_niceness", "0")  # or they get nothing of a busy machine
    cluster = Cluster(initialize_head=True, head_node_args={**NODE, "num_cpus": 0, "include_dashboard": False})
    cluster.first = cluster.add_node(**NODE)
    yield cluster
    ray.shutdown()
    cluster.shutdown()
    monkeypatch.undo()


def run(cluster, plan, store, act=lambda told: None):
    """A batch on the cluster; returns what it told."""
    told = []

    def tell(what, job, row):
        told.append((what, job.prompt))
        act(told)

    pool = on_cluster(cluster.address)(store, Setup(SMALL, command=COMMAND), 0)
    try:
        command.carry_out(plan, store, pool, SMALL, tell)
    finally:
        pool.close()
    return told


def test_nodes_that_do_not_see_the_folder_send_their_files(cluster, tmp_path):
    scenes = [tmp_path / name for name in ("a.blend", "b.blend")]
    for scene in scenes:
        scene.write_bytes(b"a scene")
    shot = SceneGroup("a.blend", scenes[0], "digest", ("noir", "fails"), (0,), (), (scenes[1],))
    plan = BatchPlan([shot])
    with Store(tmp_path / "out") as store:
        store.token = "a folder that no node sees"
        told = run(cluster, plan, store)
        rows = {row["prompt"]: row for row in map(store.row, plan)}
    assert [rows[p]["status"] for p in ("noir", "fails")] == ["done", "failed"]
    folder = tmp_path / "out" / rows["noir"]["folder"]
    assert {"after.png", "vibed.blend", "preset.json", "log.txt", "done.json"} <= {p.name for p in folder.iterdir()}
    log = (folder / "log.txt").read_text()
    assert "a.blend" in log
    assert "b.blend" in log
    assert str(tmp_path) not in log  # it was done on copies that were sent
    assert len(told) == 4


def test_a_node_that_dies_costs_nothing_and_one_that_comes_helps(cluster, tmp_path):
    """Its jobs are done elsewhere, all others once, and the results are those of one machine."""
    came = []

    def replace_it(told):
        if not came and sum(w == "done" for w, _ in told) >= 2:
            came.append(cluster.add_node(**NODE))
            cluster.remove_node(cluster.first, allow_graceful=False)

    plan = plan_of(*PROMPTS)
    with Store(tmp_path / "ray") as store:
        told = run(cluster, plan, store, replace_it)
        assert {row["status"] for row in map(store.row, plan)} == {"done"}
    done = [prompt for what, prompt in told if what == "done"]
    lost = [prompt for what, prompt in told if what == "lost"]
    assert sorted(done) == sorted(PROMPTS)
    assert 1 <= len(lost) <= 2
    assert len([what for what, _ in told if what == "started"]) == len(PROMPTS) + len(lost)
    carry_out(tmp_path / "local", plan, SMALL, workers=2)
    assert contents(tmp_path / "ray") == contents(tmp_path / "local")


def test_a_lost_head_ends_the_batch_in_one_line_and_the_next_run_continues(cluster, tmp_path):
    """What was done stays, the rest is done once more, and the results are those of an unbroken run."""
    plan, out = plan_of(*PROMPTS), tmp_path / "out"
    program = [sys.executable, str(ROOT / "tests" / "batch_parts.py"), str(out), *PROMPTS]
    variables = {**os.environ, "RAY_CLUSTER": cluster.address}
    with subprocess.Popen(program, env=variables, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        deadline = time.monotonic() + 240
        while len(list(out.glob("jobs/*/done.json"))) < 2 and process.poll() is None:
            assert time.monotonic() < deadline
            time.sleep(0.1)
        cluster.remove_node(cluster.head_node, allow_graceful=False)
        said = process.communicate(timeout=120)[0].decode()
    assert process.returncode == 1, said
    assert "vibe: The cluster's head is lost." in said
    assert "Traceback" not in said
    before = len(list(out.glob("jobs/*/done.json")))
    assert 2 <= before < len(PROMPTS)
    told, rows = carry_out(out, plan, SMALL, workers=2)
    assert {row["status"] for row in rows} == {"done"}
    assert len([what for what, _ in told if what == "started"]) == len(PROMPTS) - before
    carry_out(tmp_path / "unbroken", plan, SMALL, workers=2)
    assert contents(out) == contents(tmp_path / "unbroken")
