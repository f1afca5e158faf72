# SPDX-License-Identifier: Apache-2.0
"""Batches of simulated jobs on a real Ray cluster of several nodes on this machine, one of which dies."""

import os
from pathlib import Path

import pytest
from batch_parts import COMMAND, carry_out, plan_of
from test_batch_jobs import contents

from proxy_renderer.batch import schedule
from proxy_renderer.batch.manifest import Limits, Shot
from proxy_renderer.batch.plan import Plan
from proxy_renderer.batch.store import Store
from proxy_renderer.batch.worker import Setup

ray = pytest.importorskip("ray", reason="Ray is not installed")
LIMITS = Limits(free_gb=0.0, cores=1, memory_gb=0.1, retries=0)
PROMPTS = [f"slow {n}" for n in range(24)]
NODE = {"num_cpus": 2, "memory": 10**9, "object_store_memory": 80_000_000}
ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def cluster():
    """A head without workers, and two nodes with room for two each."""
    monkeypatch = pytest.MonkeyPatch()
    from ray.cluster_utils import Cluster

    paths = [str(ROOT), str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(paths))
    cluster = Cluster(
        initialize_head=True, head_node_args={**NODE, "num_cpus": 0, "include_dashboard": False}
    )
    cluster.nodes = [cluster.add_node(**NODE) for _ in range(2)]
    yield cluster
    ray.shutdown()
    cluster.shutdown()
    monkeypatch.undo()


def run(cluster, plan, store, act=lambda what, job: None):
    """A batch on the cluster; returns what it told."""
    from proxy_renderer.batch.cluster import cluster_pool

    told = []

    def tell(what, job, row):
        told.append((what, job.prompt))
        act(what, told)

    pool = cluster_pool(cluster.address, store, Setup(LIMITS, command=COMMAND))
    try:
        schedule.run(plan, store, pool, LIMITS, tell)
    finally:
        pool.close()
    return told


def test_nodes_that_do_not_see_the_folder_send_their_files(cluster, tmp_path):
    scene = tmp_path / "a.blend"
    scene.write_bytes(b"a scene")
    plan = Plan([Shot("a.blend", scene, "digest", ("noir", "misty", "fails"), (0,), ())])
    with Store(tmp_path / "out") as store:
        store.token = "a folder that no node sees"
        told = run(cluster, plan, store)
        rows = {row["prompt"]: row for row in store.rows(plan)}
    assert [rows[p]["status"] for p in ("noir", "misty", "fails")] == ["done", "done", "failed"]
    folder = tmp_path / "out" / rows["noir"]["folder"]
    assert {"after.png", "vibed.blend", "preset.json", "log.txt", "done.json"} <= {
        p.name for p in folder.iterdir()
    }
    assert str(scene) not in (folder / "log.txt").read_text()  # it was done on a copy that was sent
    assert len(told) == 6


def test_a_node_that_dies_costs_nothing_and_one_that_comes_helps(cluster, tmp_path):
    """Its jobs are done elsewhere, all others once, and the results are those of one machine."""
    killed = []

    def kill_one(what, told):
        if not killed and sum(w == "done" for w, _ in told) >= 3:
            killed.append(cluster.nodes.pop())
            cluster.remove_node(killed[0], allow_graceful=False)
            cluster.add_node(**NODE)

    plan = plan_of(*PROMPTS)
    with Store(tmp_path / "ray") as store:
        told = run(cluster, plan, store, kill_one)
        assert {row["status"] for row in store.rows(plan)} == {"done"}
    done = [prompt for what, prompt in told if what == "done"]
    lost = [prompt for what, prompt in told if what == "lost"]
    assert killed
    assert sorted(done) == sorted(PROMPTS)
    assert 1 <= len(lost) <= 2
    assert len([what for what, _ in told if what == "started"]) == len(PROMPTS) + len(lost)
    carry_out(tmp_path / "local", plan, LIMITS, workers=2)
    assert contents(tmp_path / "ray") == contents(tmp_path / "local")
