# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless vibe: opens and exports the shots, has the engine find the look, renders, measures and saves."""

import argparse
import os
import signal
import socket
import tempfile
import threading
import time
from collections.abc import Generator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import bpy

from ..core import preferences
from ..core.files import Outputs
from ..core.schema_import import messages, options, schema
from ..engine.process import Engine
from ..export import notes
from ..export.analysis import SceneAnalysis
from ..looks import transfer
from ..render import anchors, final_render
from ..run.driver import Driver
from ..run.notes import words_of
from ..scene import bindings, own_keys
from ..scene.steps import Change, Steps
from ..scene.subject import remember_subject
from . import summary
from .arguments import Reporter
from .scenes import ShotList, save_blend
from .summary import numbered

_SAMPLES_BEFORE = 16  # at most, of the render before the vibe, which only serves for comparison, and is denoised
_PAUSE = 0.02  # seconds between two checks for the engine's messages: the engine needs the core


class HeadlessVibe(Driver):
    """One vibe of all shots of a command line.

    `change`: the effect of a further sentence on the steps; None for a first prompt. `shown`: an image of the scene to
    copy as before.png; None to render it.
    """

    def __init__(
        self,
        args: argparse.Namespace,
        reporter: Reporter,
        engine: Engine,
        change: Change | None = None,
        shown: Path | None = None,
    ) -> None:
        self._temporary = tempfile.TemporaryDirectory(prefix="vibe-", ignore_cleanup_errors=True)
        super().__init__(engine, Path(self._temporary.name))
        self._args, self._reporter = args, reporter
        self._seconds: dict[str, float] = {}  # stage -> its duration
        self._last_lap = time.monotonic()
        self._out = Outputs(args.out)
        self._shown = shown
        self._change = change or Change(Steps(), title=args.prompt, first=True)
        self._steps = self._change.steps
        self._shots = ShotList(args, self._job, reporter, self._change)
        self._measured: list[messages.Finished] = []
        self._skipped: dict[str, str] = {}  # key -> why its value was not written
        self._lights: dict[str, dict[str, list[str]]] = {}  # file name -> pass name -> names of its lights
        self._unlit = False  # True if the first shot, the one of `Stage.lit`, renders black before the vibe

    def run(self) -> SceneAnalysis:
        """Runs the vibe to its end; returns the analysis of the last shot, whose scene has the new values."""
        with self._temporary:
            with self._out:
                for _ in self._run():
                    time.sleep(_PAUSE)
                result = self._result
                assert result is not None
                report = self._report(result)
                self._out.write_json("report.json", report)
            lines = summary.closing_lines(self._shots, result, self._measured, report, self.sequence)
            self._reporter.result(lines, result.stopped, words_of(self._measured[0].verdicts, "missed"))
        return self._shots.jobs[-1].analysis

    def _report(self, result: messages.Result) -> dict[str, Any]:
        """The content of report.json: the engine's report and Blender's. Measurements of several shots are averaged."""
        args, measured, fields = self._args, self._measured, dict(result.report)
        timings = {**self._seconds, **{f"engine: {k}": v for k, v in fields.pop("timings", {}).items()}}
        versions = {**fields.pop("versions", {}), "blender": bpy.app.version_string}
        warnings = [warning for job in self._shots.jobs for warning in job.warnings]
        shots = [
            {
                "name": shot.name, "scene": Path(shot.scene).stem, "blend": self._blend_of(number),
                "camera": shot.camera, "frame": shot.frame, "before": numbered("before.png", number),
                "after": numbered("after.png", number), **summary.measurements([each]),
            }
            for number, (shot, each) in enumerate(zip(self._shots.shots, measured, strict=True))
        ]  # fmt: skip
        sequence = [
            {"frame": each.frame, "lost": each.lost}
            | ({"note": each.note} if each.note else {"verdicts": each.verdicts})
            for each in self.sequence
        ]
        return {
            **fields,
            "scene": os.path.basename(args.scene or bpy.data.filepath) or args.command,
            "subject": sorted(self._shots.subjects[0]),
            **summary.measurements(measured),
            **({"shots": shots} if len(shots) > 1 else {}),
            "stopped": result.stopped,
            "not_written": self._skipped,
            "warnings": notes.shortened_notes([*warnings, *fields.get("anchored", {}).get("notes", [])]),
            "timings": {**timings, "total": round(sum(self._seconds.values()), 2)},
            "versions": versions,
            "steps": self._steps.rows(),
            **({"lights": self._lights} if self._lights else {}),
            **({"sequence": sequence} if sequence else {}),
        }

    def _blend_of(self, number: int) -> str:
        scenes = list(dict.fromkeys(self._args.scenes))
        return numbered(
            "vibed.blend", number if self._args.grade_each else scenes.index(self._shots.shots[number].scene)
        )

    def _lap(self, name: str) -> None:
        now = time.monotonic()
        self._seconds[name] = round(self._seconds.get(name, 0.0) + now - self._last_lap, 2)
        self._last_lap = now

    def _run(self) -> Generator[str]:
        """The vibe's steps: the search for the look, then each shot is rendered and saved with the look."""
        self._shots.export()
        self._lap("open and export")
        several = len(self._shots) > 1
        shots = [
            messages.Shot(str(job.folder), shot.name, shot.scene)
            for job, shot in zip(self._shots.jobs, self._shots.shots, strict=True)
        ]
        free_camera = self._shots.bare and not several
        chosen = options.engine_options(self._args, camera=free_camera, online=preferences.online())
        chosen = replace(chosen, goes_on=not self._change.first)
        words, others = self._args.prompt, shots if several else []
        self._ask(messages.Vibe(schema.schema_hash(), shots[0].job, words, asdict(chosen), shots=others))
        # Render before.png while the engine works. Backwards, because the last shot is still open.
        for number in reversed(range(len(self._shots))):
            if self._shown:
                self._out.copy("before.png", self._shown)
                scene = self._shots.show(number).analysis.scene
            else:
                scene = self._render(number, "before.png", min(self._args.samples, _SAMPLES_BEFORE))
            if final_render.is_black(self._out.path(numbered("before.png", number))):
                notes.check_shows(scene, self._shots.jobs[number].filling, lit=True)
                self._unlit |= number == 0
        self._lap("render before")
        result = yield from self._answer(messages.Result)
        self._lap("wait for the engine")
        for number in range(len(self._shots)):
            yield from self._finish_shot(number, result)
        if self._args.check_every:
            yield from self._check_sequence()
        # A preset of every variant, and their contact sheet.
        job, prompt = self._shots.jobs[0], result.report["prompt"]
        for number, variant in enumerate(result.variants, start=1):
            scene_job, name = job.with_additions_of(variant.values), f"{number}: {prompt}"
            look = transfer.extract_look(prompt, scene_job, variant.values, name, result.report["goals"])
            self._out.write_text(f"preset-{number}.json", look.dumps())
        if result.variants:
            self._out.copy(messages.VARIANTS, Path(job.folder) / messages.VARIANTS)

    def _finish_shot(self, number: int, result: messages.Result) -> Generator[str]:
        """Writes the result into a shot's scene, renders and saves the scene; the engine measures the render."""
        args, shots, out = self._args, self._shots, self._out
        # Of the shots in a .blend, the first writes the values and the last saves it, unless each has its own grade.
        analysis, siblings = shots.show(number).analysis, shots.siblings(number)
        if args.grade_each or number == siblings[0]:
            values = self._values(number, result)
            self._skipped |= bindings.write(analysis.scene, values, analysis.objects, analysis.pivot)
            remember_subject(analysis.scene, analysis.objects, shots.choice)
        if len(shots) == 1:
            self._add_step(result)
        self._reporter.stage("rendering with Cycles")
        self._render(number, "after.png", args.samples)
        if args.figures:
            mask = out.path(numbered("mask.png", number))
            final_render.render_mask(analysis.scene, mask, args.size, analysis.objects)
        self._lap("render after")
        # The engine writes compare.png outside `out`: a failure empties `out` while the engine may still write.
        before, after = (str(out.path(numbered(name, number))) for name in ("before.png", "after.png"))
        folder = Path(shots.jobs[number].folder)
        compared = folder / "compare.png"
        self._ask(messages.Finish(before, after, str(compared), shot=number))
        if number == 0:
            values = result.values if self._change.first else self._steps.values()
            scene, report = shots.jobs[0].with_additions_of(values), result.report
            look = transfer.extract_look(report["prompt"], scene, values, goals=report["goals"])
            out.write_text("preset.json", look.dumps())
        if args.grade_each or number == siblings[-1]:
            if not args.grade_each:
                shots.restore()
            own_keys.release(analysis.scene)
            save_blend(out.path(self._blend_of(number)))
        self._measured.append((yield from self._answer(messages.Finished)))
        out.copy("compare.png", compared)
        if args.then:
            out.copy(f"step-{self._steps.shown}.png", out.path("after.png"))
        out.copy(numbered("predicted.png", number), folder / result.prediction)
        self._lap("save and measure")

    def _check_sequence(self) -> Generator[str]:
        """Checks frames of the scene with the look; saves an image of those where a word is no longer visible."""
        analysis, args, verdicts = self._shots.show(0).analysis, self._args, self._measured[0].verdicts
        choice = self._shots.choice
        yield from self._check_frames(analysis.scene, args.check_every, verdicts, choice, args.seed, analysis)
        if pictures := [each.picture for each in self.sequence if each.picture and each.lost]:
            final_render.join_pictures(pictures, self._out.path("sequence.png"))
        self._shots.restore()
        self._lap("check the sequence")

    def _show_frame(self, frame: int) -> None:
        self._reporter.stage(f"checking frame {frame}")

    def _values(self, number: int, result: messages.Result) -> dict[str, Any]:
        """Key -> value to write into a shot's scene: the values of all shots of the same .blend.

        With `--grade-each`, parameters of the film (grade, exposure) are this shot's own: its new values, or those that
        its scene had.
        """
        if not result.shots:
            return result.values
        values = {key: value for i in self._shots.siblings(number) for key, value in result.shots[i].items()}
        if not self._args.grade_each:
            return values
        instances = self._shots.jobs[number].instances
        film = {key: list(instance.value) for key, instance in instances.items() if key.startswith("film/")}
        return values | {key: value for key, value in film.items() if key in values} | result.shots[number]

    def _add_step(self, result: messages.Result) -> None:
        """Stores the result in the scene as a step, from which further sentences can go on."""
        job, steps = self._shots.jobs[0], self._steps
        before = {key: instance.value for key, instance in job.before.items()}
        written = {k: v for k, v in result.values.items() if k not in self._skipped}
        reasons = {key: row["reason"] for key, row in result.report["parameters"].items()}
        steps.pivot = list(job.analysis.pivot)
        self._change.title = self._change.title or result.report["prompt"]
        steps.add(self._change, before, written, reasons, result.report["goals"])
        steps.store(job.analysis.scene)

    def _render(self, number: int, name: str, samples: int) -> bpy.types.Scene:
        """Renders a shot to a file ("after.png" also with its light layers, if requested); returns the shot's scene."""
        scene, args = self._shots.show(number).analysis.scene, self._args
        lights = numbered("lights.exr", number) if args.light_mix and name == "after.png" else ""
        path = self._out.path(lights) if lights else None
        layers = final_render.render_picture(
            scene, self._out.path(numbered(name, number)), args.size, samples, args.seed, lights=path
        )
        self._lights |= summary.light_rows(lights, layers)
        return scene

    def _show_message(self, message: messages.Message) -> None:
        if isinstance(message, messages.Stage) and self._unlit and not message.lit:
            job = self._shots.show(0)
            notes.check_shows(job.analysis.scene, job.filling, lit=False)

    def _anchor(self, request: messages.Anchor) -> messages.Anchored:
        name = self._shots.shots[request.shot].name
        self._reporter.stage(f"comparing with Cycles, render {request.number}{f', {name}' if name else ''}")
        job = self._shots.show(request.shot)
        analysis = job.analysis
        return anchors.answer_anchor(analysis.scene, job.folder, request, analysis.objects, analysis.pivot)


def run_one(vibe: HeadlessVibe, queue: list[Any]) -> SceneAnalysis:
    """Runs a vibe as `HeadlessVibe.run`; Ctrl-C ends its search early and empties `queue`, the list of later work."""
    # Python runs signal handlers only between its own instructions, so not while Cycles renders. Therefore signal
    # numbers are written to a socket, which a thread reads.
    reading, writing = socket.socketpair()
    writing.setblocking(False)
    for number in (signal.SIGINT, signal.SIGTERM, getattr(signal, "SIGBREAK", None)):
        if number is not None:
            signal.signal(number, lambda number, frame: None)
    signal.set_wakeup_fd(writing.fileno(), warn_on_full_buffer=False)

    def watch() -> None:
        with writing:  # keeps the socket open while the thread reads
            reading.recv(1)
            queue.clear()
            vibe.stop()
            reading.recv(1)
            os._exit(130)  # a second Ctrl-C

    threading.Thread(target=watch, daemon=True).start()
    return vibe.run()
