# SPDX-License-Identifier: Apache-2.0
"""The engine as a real process: its protocol, refusals, stop, and how it ends."""

import contextlib
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from tiny_job import write_job

from proxy_renderer.schema import messages, schema_hash

ROOT = Path(__file__).parents[2]
QUICK = {"rounds": 1, "steps": 4, "size": 64, "anchor": False}
ENDLESS = {"rounds": 100, "steps": 100, "size": 64, "anchor": False}
PROMPT = "glossy teal ball, warm soft light"


class Worker:
    """A worker process, and what it says."""

    def __init__(self):
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        self.process = subprocess.Popen(
            [sys.executable, "-m", "proxy_renderer.engine.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            cwd=ROOT,
            env=environment,
        )
        self.messages = messages.read(self.process.stdout)

    def send(self, message):
        raw = message if isinstance(message, bytes) else messages.encode(message)
        self.process.stdin.write(raw)
        self.process.stdin.flush()

    def vibe(self, job, options, prompt=PROMPT, schema=None):
        self.send(messages.Vibe(schema or schema_hash(), str(job), prompt, options))

    def until(self, *kinds):
        """The next message of one of these kinds."""
        return next(m for m in self.messages if isinstance(m, kinds))


@pytest.fixture(scope="module")
def job(tmp_path_factory):
    return write_job(tmp_path_factory.mktemp("job"))


@contextlib.contextmanager
def running():
    worker = Worker()
    try:
        yield worker
    finally:
        worker.process.kill()
        worker.process.wait()


@pytest.fixture(scope="module")
def worker():
    with running() as made:
        ready = next(made.messages)
        assert ready == messages.Ready(schema_hash(), ready.version)
        yield made


def test_it_is_ready_before_it_has_imported_anything_heavy():
    start = time.monotonic()
    with running() as worker:
        assert isinstance(next(worker.messages), messages.Ready)
        assert time.monotonic() - start < 5.0


def test_a_vibe_and_its_measure(worker, job, tmp_path):
    worker.vibe(job, QUICK)
    heard = []
    while not heard or not isinstance(heard[-1], messages.Result | messages.Error):
        heard.append(next(worker.messages))
    result = heard[-1]
    assert isinstance(result, messages.Result), result
    progress = [m for m in heard if isinstance(m, messages.Progress)]
    assert progress[-1].step == 4
    assert (job / progress[0].preview).is_file()
    assert result.report["prompt"] == PROMPT
    assert set(result.values) <= set(result.report["parameters"])
    worker.send(messages.AskReadings(schema_hash(), PROMPT, str(job)))
    marks = {word.key: word.candidates[:1] for word in worker.until(messages.Readings).words}
    words = result.report["understood"]["words"]
    assert marks == {word["key"]: [word["candidates"][0]["name"]] for word in words}

    gray = tmp_path / "gray.png"
    Image.fromarray(np.full((48, 64, 3), 128, np.uint8)).save(gray)
    worker.send(messages.Finish(str(gray), str(gray), str(tmp_path / "compare.png")))
    finished = worker.until(messages.Finished, messages.Error)
    with Image.open(job / result.prediction) as picture:  # it is drawn while Blender renders
        assert picture.size == (64, 48)
    assert set(finished.prediction) == {"shown"}
    assert min(finished.prediction["shown"].values()) > 0.0
    assert set(finished.similarity) == {"before", "after"}
    with Image.open(tmp_path / "compare.png") as picture:
        picture.load()


def test_a_vibe_whose_anchors_fail(worker, job):
    worker.vibe(job, {**QUICK, "anchor": True})
    asked = worker.until(messages.Anchor)
    assert asked.number == 1
    assert asked.size == 64
    worker.send(messages.Anchored(asked.number + 7, error="not the one"))
    worker.send(messages.Anchored(asked.number, error="Blender is busy"))
    worker.send(messages.Anchored(worker.until(messages.Anchor).number, error="still busy"))
    result = worker.until(messages.Result, messages.Error, messages.Anchor)
    assert isinstance(result, messages.Result)
    notes = result.report["anchored"]["notes"]
    assert any("Blender is busy" in note for note in notes)
    assert result.report["anchored"]["pictures"] == []


def test_stop_is_heard_while_an_anchor_is_waited_for(worker, job):
    worker.vibe(job, {**ENDLESS, "anchor": True})
    asked = worker.until(messages.Anchor)
    worker.send(messages.Stop())
    result = worker.until(messages.Result, messages.Error)
    assert isinstance(result, messages.Result)
    assert result.report["anchored"]["notes"] == []
    worker.send(messages.Anchored(asked.number, error="too late"))
    worker.vibe(job, QUICK)
    assert isinstance(worker.until(messages.Result, messages.Error), messages.Result)


def test_another_schema_is_refused_and_the_engine_stays(worker, job):
    worker.vibe(job, QUICK, schema="0123456789abcdef")
    error = worker.until(messages.Result, messages.Error)
    assert isinstance(error, messages.Error)
    assert "parameter table" in error.message
    assert error.remedy
    worker.vibe(job, QUICK)
    assert isinstance(worker.until(messages.Result, messages.Error), messages.Result)


@pytest.mark.parametrize(
    ("options", "prompt", "word"),
    [
        ({"speeed": 3}, PROMPT, "speeed"),
        ({"groups": ["lights"]}, PROMPT, "lights"),
        ({"lock": ["light/Nobody"]}, PROMPT, "matches nothing"),
        ({"device": "cuda:7"}, PROMPT, "cuda:7"),
        ({"encoder": "ViT-nonsense/none"}, PROMPT, "ViT-nonsense"),
        ({}, "xqzt wrrgl", "xqzt"),
    ],
)
def test_mistakes_come_back_as_errors_with_a_remedy(worker, job, options, prompt, word):
    worker.vibe(job, {**QUICK, **options}, prompt)
    error = worker.until(messages.Result, messages.Error)
    assert isinstance(error, messages.Error), error
    assert word in error.message
    assert error.remedy


def test_a_job_that_is_not_there(worker, tmp_path):
    worker.vibe(tmp_path / "nowhere", QUICK)
    assert "cannot be read" in worker.until(messages.Error).message


def test_stop_gives_the_best_so_far(worker, job):
    worker.vibe(job, ENDLESS)
    worker.until(messages.Progress)
    start = time.monotonic()
    worker.send(messages.Stop())
    result = worker.until(messages.Result)
    assert result.stopped
    assert time.monotonic() - start < 60  # one step takes 0.1 s; 10000 were asked for
    worker.vibe(job, QUICK)  # and the next one is not stopped
    assert not worker.until(messages.Result).stopped


def test_nonsense_is_answered(job):
    with running() as worker:
        worker.send(b"hello\0")
        assert "understand" in worker.until(messages.Error).message


@pytest.mark.slow
def test_it_ends_when_the_other_side_goes(job):
    with running() as worker:
        worker.vibe(job, ENDLESS)
        worker.until(messages.Progress)
        worker.process.stdin.close()
        assert worker.process.wait(60) == 0


def test_a_killed_engine_ends_the_stream(job):
    with running() as worker:
        worker.vibe(job, ENDLESS)
        worker.until(messages.Progress)
        worker.process.kill()
        assert not any(isinstance(m, messages.Result) for m in worker.messages)
