# SPDX-License-Identifier: Apache-2.0
"""Workers: threads on this machine, or actors on every node of a Ray cluster that has room for them."""

import contextlib
import os
import queue
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import replace
from pathlib import Path
from typing import Any

import psutil

from ..schema import VibeError
from .manifest import Job, Limits
from .store import TOKEN, JobRow, Store, read_json
from .worker import Interrupted, Setup, Worker

PER_GPU = 4  # engines that share a graphics card
_LOOK = 2.0  # seconds between two looks at the cluster's nodes
_PATIENCE = 5  # attempts to reach a head node that does not answer
_FAREWELL = 10.0  # seconds that workers get to end their processes


class LocalPool:
    """Workers on this machine, each with a thread."""

    def __init__(self, jobs: Path, workers: list[Worker]) -> None:
        self._jobs, self._workers = jobs, workers
        self._idle: queue.SimpleQueue[Worker] = queue.SimpleQueue()
        for worker in workers:
            self._idle.put(worker)
        self._threads = ThreadPoolExecutor(len(workers))
        self._out: dict[Future[JobRow], Job] = {}

    def capacity(self) -> int:
        """Number of workers, idle or not."""
        return len(self._workers)

    def submit(self, job: Job) -> None:
        """Hands a job to the next worker that is idle."""
        self._out[self._threads.submit(self._run, job)] = job

    def wait(self, seconds: float) -> list[tuple[Job, JobRow | None]]:
        """Waits for jobs to end; returns them with their rows. If a worker was closed, the status is "interrupted"."""
        ended, _ = wait(self._out, seconds, FIRST_COMPLETED)
        return [(self._out.pop(future), future.result()) for future in ended]

    def close(self) -> None:
        """Ends the jobs that run, forgets those that wait, and returns when all threads have ended."""
        for worker in self._workers:
            worker.close()
        self._threads.shutdown(wait=True, cancel_futures=True)

    def _run(self, job: Job) -> JobRow:
        worker = self._idle.get()
        try:
            return worker.run(job, self._jobs / job.name)
        except Interrupted:
            return {"status": "interrupted"}
        finally:
            self._idle.put(worker)


def local_pool(jobs: Path, setup: Setup, count: int = 0) -> LocalPool:
    """A pool of `count` workers on this machine (0: as many as fit). Several get separate CPU cores, GPUs in turn."""
    count = count or fitting(machine(), setup.limits) or 1
    cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
    cards, workers = graphics_cards(), []
    for number in range(count):
        first = number * setup.limits.cores
        mine = cores[first : first + setup.limits.cores] if count > 1 else []
        card = {"CUDA_VISIBLE_DEVICES": str(number % cards)} if cards else {}
        workers.append(Worker(replace(setup, variables=setup.variables | card), mine))
    return LocalPool(jobs, workers)


def fitting(resources: Mapping[str, float], limits: Limits) -> int:
    """Number of workers that fit on a machine; 0 if it is too small. `resources`: see `machine`."""
    fits = [resources.get("CPU", 0) // limits.cores, resources.get("memory", 0) / 1e9 // limits.memory_gb]
    fits += [cards * PER_GPU] if (cards := resources.get("GPU")) else []
    return int(min(fits))


def machine() -> dict[str, float]:
    """The resources of this machine under Ray's names: "CPU" (cores), "memory" (bytes), "GPU" (cards)."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return {"CPU": cores, "memory": psutil.virtual_memory().total, "GPU": graphics_cards()}


def graphics_cards() -> int:
    """Number of CUDA cards, found without importing torch."""
    chosen = os.environ.get("CUDA_VISIBLE_DEVICES")
    if chosen is not None:
        return len([c for c in chosen.split(",") if c.strip()])
    if not shutil.which("nvidia-smi"):
        return 0
    done = subprocess.run(["nvidia-smi", "-L"], capture_output=True, text=True, timeout=30)
    return done.stdout.count("GPU ") if done.returncode == 0 else 0


class Station(Worker):
    """A worker on a node of a Ray cluster, in a process that Ray starts there (an actor).

    `out` is the results folder; this machine sees it if its token file has the same `token`.
    """

    def __init__(self, setup: Setup, out: Path, token: str) -> None:
        super().__init__(setup)
        self._jobs = out / "jobs"
        self._shares = (read_json(out / TOKEN) or {}).get("token") == token
        self._node = os.getppid()  # Ray's process on this node, which has started this one

    def shares(self) -> bool:
        """True if this machine sees the results folder."""
        return self._shares

    def attempt(self, job: Job, *scenes: bytes) -> tuple[JobRow, dict[str, bytes]]:
        """Carries out a job; returns its row and its files by path, {} if they are in the results folder already.

        `scenes` are the job's scene files, for a machine without this folder. Raises Interrupted if the node has died.
        """
        files: dict[str, bytes] = {}
        if self._shares:
            row = self.run(job, self._jobs / job.name)
        else:
            with tempfile.TemporaryDirectory(prefix="vibe-batch-") as place:
                folder, sources = Path(place) / "out", []
                for number, (source, content) in enumerate(zip((job.source, *job.more), scenes, strict=True)):
                    sources.append(Path(place) / str(number) / source.name)  # several may have one name
                    sources[-1].parent.mkdir()
                    sources[-1].write_bytes(content)
                row = self.run(replace(job, source=sources[0], more=tuple(sources[1:])), folder)
                for path in folder.rglob("*"):
                    if path.is_file() and not path.name.startswith("."):
                        files[path.relative_to(folder).as_posix()] = path.read_bytes()
        if row["status"] == "failed" and os.getppid() != self._node:
            # The node has died: Ray has killed Blender before this process. The job has not failed.
            raise Interrupted
        return row, files


class RayPool:
    """Workers (`Station`) on a Ray cluster: as many as its nodes have room for, at most `most` (0: no limit)."""

    def __init__(self, address: str, store: Store, setup: Setup, most: int = 0) -> None:
        """Connects to a cluster by its head's HOST:PORT, or "auto". Raises VibeError if that fails."""
        os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
        try:
            import ray
        except ImportError as error:
            raise VibeError("Ray is not installed.", "Run `pip install '.[ray]'` on every machine.") from error
        try:
            ray.init(address=address, log_to_driver=False, logging_level="error", ignore_reinit_error=True)
        except (ConnectionError, RuntimeError, ValueError) as error:
            remedy = "Start one with `ray start --head`, and join it with `ray start --address HOST:6379`."
            raise VibeError(f"There is no Ray cluster at {address}.", remedy) from error
        self._ray, self._store, self._setup, self._most = ray, store, setup, most
        self._station = ray.remote(Station)
        self._nodes: dict[str, list[Any]] = {}
        self._coming: dict[Any, Any] = {}  # Ray's reference to the answer of `shares` -> station
        self._ready: dict[Any, bool] = {}  # station -> whether it shares the folder
        self._idle: list[Any] = []
        self._out: dict[Any, tuple[Any, Job]] = {}
        self._scenes: dict[Path, Any] = {}  # scene file -> Ray's reference to its content in the object store
        self._next = 0.0
        self._lost = False

    def capacity(self) -> int:
        """Number of stations that are ready now."""
        return len(self._ready)

    def submit(self, job: Job) -> None:
        """Sends a job to an idle station, with its scenes where the station does not share the folder."""
        station = self._idle.pop()
        sources = () if self._ready[station] else (job.source, *job.more)
        for source in sources:
            if source not in self._scenes:
                self._scenes[source] = self._ray.put(source.read_bytes())
        self._out[station.attempt.remote(job, *(self._scenes[source] for source in sources))] = (station, job)

    def wait(self, seconds: float) -> list[tuple[Job, JobRow | None]]:
        """Waits for jobs and new stations; returns ended jobs with their rows, None for one whose station has died."""
        self._look()
        waiting = [*self._coming, *self._out]
        if not waiting:
            time.sleep(seconds)
            return []
        ended, _ = self._ray.wait(waiting, num_returns=1, timeout=seconds)
        for reference in ended:
            if station := self._coming.pop(reference, None):
                try:
                    self._ready[station] = self._ray.get(reference)
                    self._idle.append(station)
                except self._ray.exceptions.RayError:  # gone before it came
                    self._forget(station)
        return [self._end(reference) for reference in ended if reference in self._out]

    def close(self) -> None:
        """Ends all stations now, and leaves the cluster."""
        stations = [s for group in self._nodes.values() for s in group]
        with contextlib.suppress(Exception):  # the cluster may be gone, and its stations with it
            farewells = [station.close.remote() for station in stations]
            self._ray.wait(farewells, num_returns=len(farewells), timeout=_FAREWELL)
            if self._lost:
                return  # the next calls would wait for the lost head
            for station in stations:
                self._ray.kill(station)
        self._ray.shutdown()

    def _look(self) -> None:
        """Starts stations on new nodes, drops those of nodes that are gone. Raises VibeError if the head node is gone."""
        from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _LOOK
        host, port = self._ray.get_runtime_context().gcs_address.rsplit(":", 1)
        for _ in range(_PATIENCE):
            with contextlib.suppress(OSError):
                socket.create_connection((host, int(port)), _LOOK).close()
                break
            time.sleep(_LOOK)
        else:  # reported here, because Ray would end this process without a message
            self._lost = True
            remedy = "Bring it back, then run the same command again: it continues with what is done."
            raise VibeError("The cluster's head is lost.", remedy)
        alive = {node["NodeID"]: node["Resources"] for node in self._ray.nodes() if node["Alive"]}
        for gone in set(self._nodes) - set(alive):
            for station in list(self._nodes[gone]):
                self._forget(station)
            del self._nodes[gone]
        for node, resources in alive.items():
            group = self._nodes.setdefault(node, [])
            for _ in range(fitting(resources, self._setup.limits) - len(group)):
                if self._most and sum(map(len, self._nodes.values())) >= self._most:
                    return
                station = self._station.options(
                    num_cpus=self._setup.limits.cores,
                    num_gpus=1 / PER_GPU if resources.get("GPU") else 0,
                    max_concurrency=2,  # so that it can be closed while it works
                    scheduling_strategy=NodeAffinitySchedulingStrategy(node, soft=False),
                ).remote(self._setup, self._store.folder, self._store.token)
                self._coming[station.shares.remote()] = station
                group.append(station)

    def _forget(self, station: Any) -> None:
        """Removes a station that has died; `_look` starts another if the node is still alive."""
        for group in self._nodes.values():
            if station in group:
                group.remove(station)
        self._ready.pop(station, None)
        if station in self._idle:
            self._idle.remove(station)

    def _end(self, reference: Any) -> tuple[Job, JobRow | None]:
        """The job that ended, and its row, or None if its station has died; writes the result files that it sent."""
        station, job = self._out.pop(reference)
        try:
            row, files = self._ray.get(reference)
        except self._ray.exceptions.RayError as error:
            if isinstance(error, self._ray.exceptions.RayTaskError) and not isinstance(error.cause, Interrupted):
                raise
            self._forget(station)
            return job, None
        if files:
            self._store.receive(job, files)
        if station in self._ready:
            self._idle.append(station)
        return job, row


Pool = LocalPool | RayPool
