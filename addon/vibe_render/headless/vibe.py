# SPDX-License-Identifier: GPL-3.0-or-later
"""A headless vibe: opens and exports the shots, asks the engine, renders, measures and saves."""

from __future__ import annotations

import argparse
import json
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import bpy

from ..core import preferences
from ..core.files import Outputs
from ..core.schema_import import command_line, messages, schema
from ..engine.conversation import Conversation, on_interrupt
from ..engine.process import Engine
from ..export.analysis import SceneAnalysis
from ..looks import take
from ..render import anchors, black, final_render
from ..run.notes.claims import words_shown
from ..scene import bindings, stored_subject
from . import summary
from .reporter import Reporter
from .scenes import save_blend
from .shots import ShotList
from .summary import Stopwatch, numbered

_SAMPLES_BEFORE = 16
"""The most that the picture before takes: it is only compared with, and the denoiser does the rest."""


def run(args: argparse.Namespace, reporter: Reporter) -> None:
    """Runs one vibe with an engine of its own, from opening the scene to the saved files."""
    engine = Engine(args.engine)
    engine.start()  # first, so that engine and scene load at the same time
    conversation = Conversation(engine, reporter.engine)
    on_interrupt(conversation.stop)
    try:
        run_with_engine(args, reporter, conversation)
    except BaseException:
        engine.stop(patience=0.1)  # it may be busy
        raise
    engine.stop()


def run_with_engine(
    args: argparse.Namespace, reporter: Reporter, conversation: Conversation
) -> SceneAnalysis:
    """Runs one vibe with an engine that is running, and keeps running: another vibe can follow.

    Args:
        args: The command line, from `arguments.parse`.
        reporter: Hears of every stage, and of the result.

    Returns:
        What is known about the last shot's scene, which has its new values now.

    Raises:
        VibeError: A mistake in what was asked for, or the engine's error.
    """
    temporary = tempfile.TemporaryDirectory(prefix="vibe-", ignore_cleanup_errors=True)
    with temporary as folder, Outputs(args.out) as out:
        shot_list = ShotList(args, Path(folder), reporter)
        vibe = _Run(args, shot_list, conversation, out, reporter, Stopwatch())
        result = vibe.search()
        measured, skipped = vibe.finish(result)
        fields = summary.report_fields(args, shot_list, result, measured, skipped, vibe.stopwatch)
        out.write_json("report.json", fields)
    lines = summary.closing_lines(shot_list, result, measured, skipped)
    missing = [word for word, what in words_shown(measured[0].claims).items() if what]
    reporter.result(lines, result.stopped, missing)
    return shot_list.jobs[-1].analysis


@dataclass(frozen=True)
class _Run:
    """One vibe, and what every step of it needs."""

    args: argparse.Namespace
    shot_list: ShotList
    conversation: Conversation
    out: Outputs
    reporter: Reporter
    stopwatch: Stopwatch

    def search(self) -> messages.Result:
        """Exports the shots, and renders them while the engine looks for their look."""
        self.shot_list.export()
        self.stopwatch.lap("open and export")
        self.conversation.ask(self._request())
        for number in reversed(range(len(self.shot_list))):  # the last one is still open
            scene = self._render(number, "before.png", min(self.args.samples, _SAMPLES_BEFORE))
            if note := black.note(scene, self.out.path(numbered("before.png", number))):
                self.shot_list.jobs[number].warnings.insert(0, note)
                self.reporter.note(note)
        self.stopwatch.lap("render before")
        result = self.conversation.wait(messages.Result, self._anchor)
        self.stopwatch.lap("wait for the engine")
        return result

    def finish(self, result: messages.Result) -> tuple[list[messages.Finished], dict[str, str]]:
        """Writes the values into every shot's scene, renders, measures and saves it.

        Returns:
            The engine's measurements of each shot; and by key, why a value was not written.
        """
        measured: list[messages.Finished] = []
        skipped: dict[str, str] = {}
        for number in range(len(self.shot_list)):
            skipped |= self._write(number, result)
            self._render_after(number)
            compared = self._ask_to_measure(number)
            if number == 0:
                look = take.extract(
                    result.report["prompt"],
                    self.shot_list.jobs[0].with_additions_of(result.values),
                    result.values,
                    goals=_goals(result),
                )
                self.out.write_text("preset.json", look.dumps())
            self._save(number)
            measured.append(self.conversation.wait(messages.Finished))
            self.out.copy("compare.png", compared)
            self._copy_prediction(number, result)
            self.stopwatch.lap("save and measure")
        _write_variants(self.out, self.shot_list, result)
        return measured, skipped

    def _request(self) -> messages.Vibe:
        several = len(self.shot_list) > 1
        shots = [
            messages.Shot(str(job.folder), shot.name, shot.scene)
            for job, shot in zip(self.shot_list.jobs, self.shot_list.shots, strict=True)
        ]
        free_camera = self.shot_list.bare and not several
        options = command_line.engine_options(self.args, camera=free_camera, online=preferences.online())
        return messages.Vibe(
            schema.schema_hash(),
            shots[0].job,
            self.args.prompt,
            asdict(options),
            shots=shots if several else [],
        )

    def _anchor(self, request: messages.Anchor) -> messages.Anchored:
        """Renders an anchor of one shot."""
        name = self.shot_list.shots[request.shot].name
        self.reporter.stage(f"rendering anchor {request.number}{f', {name}' if name else ''}")
        job = self.shot_list.show(request.shot)
        analysis = job.analysis
        return anchors.answer(analysis.scene, job.folder, request, analysis.objects, analysis.pivot)

    def _render(self, number: int, name: str, samples: int) -> bpy.types.Scene:
        scene, args = self.shot_list.show(number).analysis.scene, self.args
        final_render.render(scene, self.out.path(numbered(name, number)), args.size, samples, args.seed)
        return scene

    def _write(self, number: int, result: messages.Result) -> dict[str, str]:
        """Writes the values, once for each .blend unless every shot has a grade of its own."""
        analysis = self.shot_list.show(number).analysis
        if not (self.args.grade_each or number == self.shot_list.siblings(number)[0]):
            return {}
        values = _values(self.shot_list, result, number, self.args.grade_each)
        skipped = bindings.write(analysis.scene, values, analysis.objects, analysis.pivot)
        if self.shot_list.choice.explicit:
            stored_subject.remember(analysis.scene, analysis.objects)
        return skipped

    def _render_after(self, number: int) -> None:
        self.reporter.stage("rendering with Cycles")
        self._render(number, "after.png", self.args.samples)
        if self.args.figures:
            analysis = self.shot_list.jobs[number].analysis
            mask = self.out.path(numbered("mask.png", number))
            final_render.render_mask(analysis.scene, mask, self.args.size, analysis.objects)
        self.stopwatch.lap("render after")

    def _ask_to_measure(self, number: int) -> Path:
        """Asks the engine to measure a shot; returns the file that it will draw the comparison into.

        It is not in `out`: a failure deletes that while the engine may still write.
        """
        before, after = (str(self.out.path(numbered(name, number))) for name in ("before.png", "after.png"))
        compared = Path(self.shot_list.jobs[number].folder) / "compare.png"
        self.conversation.ask(messages.Finish(before, after, str(compared), shot=number))
        return compared

    def _copy_prediction(self, number: int, result: messages.Result) -> None:
        predicted = Path(self.shot_list.jobs[number].folder) / result.prediction
        self.out.copy(numbered("predicted.png", number), predicted)

    def _save(self, number: int) -> None:
        """Saves the .blend after its last shot, or of every shot that has a grade of its own."""
        if not (self.args.grade_each or number == self.shot_list.siblings(number)[-1]):
            return
        if not self.args.grade_each:
            self.shot_list.restore()
        save_blend(self.out.path(summary.blend_of(self.args, self.shot_list, number)))


def _values(shot_list: ShotList, result: messages.Result, number: int, grade_each: bool) -> dict[str, Any]:
    """The values to write into a shot's scene, with those of the other shots of the same .blend.

    With a grade for each, grade and exposure are this shot's own: they replace what an earlier shot has left.
    """
    if not result.shots:
        return result.values
    values = {key: value for i in shot_list.siblings(number) for key, value in result.shots[i].items()}
    if not grade_each:
        return values
    instances = shot_list.jobs[number].instances
    film = {key: list(instance.value) for key, instance in instances.items() if key.startswith("film/")}
    return values | {key: value for key, value in film.items() if key in values} | result.shots[number]


def _goals(result: messages.Result) -> str:
    """What a result was searched for by, as JSON for presets."""
    return json.dumps(result.report["goals"], ensure_ascii=False)


def _write_variants(out: Outputs, shot_list: ShotList, result: messages.Result) -> None:
    """Writes a preset of every variant, and their contact sheet."""
    job, prompt = shot_list.jobs[0], result.report["prompt"]
    for number, variant in enumerate(result.variants, start=1):
        scene, name = job.with_additions_of(variant.values), f"{number}: {prompt}"
        look = take.extract(prompt, scene, variant.values, name, _goals(result))
        out.write_text(f"preset-{number}.json", look.dumps())
    if result.variants:
        out.copy(messages.VARIANTS, Path(job.folder) / messages.VARIANTS)
