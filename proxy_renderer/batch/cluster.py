# SPDX-License-Identifier: Apache-2.0
"""Workers on a Ray cluster: the same `Worker` as on one machine, as an actor on every node that has room for it."""

import contextlib
import os
import socket
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..schema import VibeError
from .manifest import Job
from .schedule import PER_GPU, fitting
from .store import TOKEN, JobRow, Store, read_json
from .worker import Interrupted, Setup, Worker


class Station:
    """A worker in an actor's process."""

    def __init__(self, setup: Setup, out: Path, token: str) -> None:
        self._worker = Worker(setup)
        self._jobs = out / "jobs"
        self._shares = (read_json(out / TOKEN) or {}).get("token") == token
        self._node = os.getppid()  # Ray's process on this node, which has started this one

    def shares(self) -> bool:
        """True if this machine sees the results folder."""
        return self._shares

    def run(self, job: Job, *scenes: bytes) -> tuple[JobRow, dict[str, bytes]]:
        """Carries out a job; returns its row, and its files by path if this machine does not see the results folder."""
        row, files = self._carry_out(job, *scenes)
        if row["status"] == "failed" and os.getppid() != self._node:
            # The node has died: Ray has killed Blender before this process. The job has not failed.
            raise Interrupted
        return row, files

    def _carry_out(self, job: Job, *scenes: bytes) -> tuple[JobRow, dict[str, bytes]]:
        if self._shares:
            return self._worker.run(job, self._jobs / job.name), {}
        with tempfile.TemporaryDirectory(prefix="vibe-batch-") as place:
            folder, sources = Path(place) / "out", []
            for number, (source, content) in enumerate(zip((job.source, *job.more), scenes, strict=True)):
                sources.append(Path(place) / str(number) / source.name)  # several may have one name
                sources[-1].parent.mkdir()
                sources[-1].write_bytes(content)
            row = self._worker.run(replace(job, source=sources[0], more=tuple(sources[1:])), folder)
            files = [p for p in folder.rglob("*") if p.is_file() and not p.name.startswith(".")]
            return row, {p.relative_to(folder).as_posix(): p.read_bytes() for p in files}

    def close(self) -> None:
        """Ends the running job."""
        self._worker.close()


_LOOK = 2.0  # seconds between two looks at the cluster's nodes
_PATIENCE = 5  # attempts to reach a head node that does not answer
_FAREWELL = 10.0  # seconds that workers get to end their processes


class RayPool:
    """A `Pool` of stations: as many as the nodes have room for, and at most `most` unless that is 0."""

    def __init__(self, ray: Any, store: Store, setup: Setup, most: int = 0) -> None:
        self._ray, self._store, self._setup, self._most = ray, store, setup, most
        self._station = ray.remote(Station)
        self._nodes: dict[str, list[Any]] = {}
        self._coming: dict[Any, Any] = {}  # Ray's reference to the answer of `shares` -> station
        self._ready: dict[Any, bool] = {}  # station -> whether it shares the folder
        self._idle: list[Any] = []
        self._out: dict[Any, tuple[Any, Job]] = {}
        self._scenes: dict[Path, Any] = {}
        self._next = 0.0
        self._lost = False

    def capacity(self) -> int:
        """Number of stations that are ready now."""
        return len(self._ready)

    def submit(self, job: Job) -> None:
        """Sends a job to an idle station, with its scenes where the station does not share the folder."""
        station = self._idle.pop()
        sources = () if self._ready[station] else (job.source, *job.more)
        self._out[station.run.remote(job, *map(self._scene, sources))] = (station, job)

    def wait(self, seconds: float) -> list[tuple[Job, JobRow | None]]:
        """As `Pool.wait`; also registers stations that have started, and drops those that have died."""
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
        """Starts stations on new nodes, and drops the stations of nodes that are gone."""
        if time.monotonic() < self._next:
            return
        self._next = time.monotonic() + _LOOK
        self._check_head()
        alive = {node["NodeID"]: node["Resources"] for node in self._ray.nodes() if node["Alive"]}
        for gone in set(self._nodes) - set(alive):
            for station in list(self._nodes[gone]):
                self._forget(station)
            del self._nodes[gone]
        for node, resources in alive.items():
            group = self._nodes.setdefault(node, [])
            for _ in range(fitting(resources, self._setup.limits) - len(group)):
                if not self._most or sum(map(len, self._nodes.values())) < self._most:
                    group.append(self._start(node, resources))

    def _check_head(self) -> None:
        """Raises VibeError if the head node is gone, before Ray notices and ends this process without a message."""
        host, port = self._ray.get_runtime_context().gcs_address.rsplit(":", 1)
        for _ in range(_PATIENCE):
            try:
                return socket.create_connection((host, int(port)), _LOOK).close()
            except OSError:
                time.sleep(_LOOK)
        self._lost = True
        remedy = "Bring it back, then run the same command again: it continues with what is done."
        raise VibeError("The cluster's head is lost.", remedy)

    def _start(self, node: str, resources: dict[str, float]) -> Any:
        from ray.util.scheduling_strategies import NodeAffinitySchedulingStrategy

        station = self._station.options(
            num_cpus=self._setup.limits.cores,
            num_gpus=1 / PER_GPU if resources.get("GPU") else 0,
            max_concurrency=2,  # so that it can be closed while it works
            scheduling_strategy=NodeAffinitySchedulingStrategy(node, soft=False),
        ).remote(self._setup, self._store.folder, self._store.token)
        self._coming[station.shares.remote()] = station
        return station

    def _forget(self, station: Any) -> None:
        """Removes a station that has died; `_look` starts another if the node is still alive."""
        for group in self._nodes.values():
            if station in group:
                group.remove(station)
        self._ready.pop(station, None)
        if station in self._idle:
            self._idle.remove(station)

    def _end(self, reference: Any) -> tuple[Job, JobRow | None]:
        """A job that has ended, and its row, None if its station has died; writes the files that the station sent."""
        station, job = self._out.pop(reference)
        try:
            row, files = self._ray.get(reference)
        except self._ray.exceptions.RayError as error:
            failed = isinstance(error, self._ray.exceptions.RayTaskError)
            if failed and not isinstance(error.cause, Interrupted):
                raise
            self._forget(station)
            return job, None
        if files:
            self._store.receive(job, files)
        if station in self._ready:
            self._idle.append(station)
        return job, row

    def _scene(self, source: Path) -> Any:
        """Ray's reference to a scene file, which the first call puts into the object store."""
        if source not in self._scenes:
            self._scenes[source] = self._ray.put(source.read_bytes())
        return self._scenes[source]


def cluster_pool(address: str, store: Store, setup: Setup, most: int = 0) -> RayPool:
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
    return RayPool(ray, store, setup, most)
