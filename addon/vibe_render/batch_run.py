# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands that need a scene: vibe it, put a preset on it, revert it."""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import bpy

from . import (
    anchoring,
    bindings,
    changes,
    demo,
    library,
    preferences,
    preset_fit,
    presets,
    rendering,
    scene_io,
    snapshot,
    stage,
)
from .batch_arguments import engine_options
from .batch_report import Reporter
from .contract import messages, schema
from .conversation import Conversation, on_interrupt
from .engine import Engine
from .export import Job
from .model_notes import model_lines
from .outputs import Outputs
from .subject import Choice
from .survey import Survey
from .word_notes import word_notes

_SHOWN = 8


def vibe(a: argparse.Namespace, reporter: Reporter) -> None:
    """Opens or builds the scene, has the engine look for the look, renders it and saves everything."""
    engine = Engine(a.engine)
    engine.start()  # first of all: it loads while the scene does
    talk = Conversation(engine, reporter.engine)
    on_interrupt(talk.stop)
    try:
        carry_out(a, reporter, talk)
    except BaseException:
        engine.stop(patience=0.1)  # it may be in the middle of something
        raise
    engine.stop()


def carry_out(a: argparse.Namespace, reporter: Reporter, talk: Conversation) -> Survey:
    """One vibe with an engine that runs already, and goes on running: many can follow one another.

    Returns:
        The scene as it was looked at; it has its new values now.
    """
    laps = _Laps()
    with tempfile.TemporaryDirectory(prefix="vibe-") as folder, Outputs(a.out) as out:
        scene, choice, bare = _open(a, reporter)
        laps.lap("open")
        reporter.stage("reading the scene")
        job = scene_io.open_job(scene, Path(folder), choice)
        laps.lap("export")
        options = engine_options(a, free_camera=bare, online=preferences.online())
        talk.ask(messages.Vibe(schema.schema_hash(), folder, a.prompt, asdict(options)))
        rendering.render(scene, out.path("before.png"), a.size, a.samples, a.seed)
        laps.lap("render before")
        found = talk.wait(messages.Result, lambda request: _anchor(request, job, reporter))
        laps.lap("wait for the engine")
        skipped = bindings.write(scene, found.values, job.survey.objects, job.survey.pivot)
        reporter.stage("rendering with Cycles")
        _render_after(scene, job.survey, a, out)
        laps.lap("render after")
        pictures = (out.path(name) for name in ("before.png", "after.png", "compare.png"))
        talk.ask(messages.Finish(*map(str, pictures)))
        save_blend(out.path("vibed.blend"))
        measured = talk.wait(messages.Finished)
        laps.lap("save and measure")
        out.write_text("preset.json", presets.extract(a.prompt, job, found.values).dumps())
        _write_variants(out, a, job, found)
        out.write_json("report.json", _report(a, job, found, measured, skipped, laps))
    reporter.result(_summary(job, found, measured, skipped), found.stopped)
    return job.survey


def _anchor(request: messages.Anchor, job: Job, reporter: Reporter) -> messages.Anchored:
    """Renders what the engine corrects itself by."""
    reporter.stage(f"rendering anchor {request.number}")
    found = job.survey
    return anchoring.answer(found.scene, job.folder, request, found.objects, found.pivot)


def export(a: argparse.Namespace, reporter: Reporter) -> None:
    """Writes what the engine needs to know of a scene into a folder, and leaves the file alone."""
    scene, choice, _ = _open(a, reporter)
    reporter.stage("reading the scene")
    scene_io.open_job(scene, a.out, choice)
    reporter.result([f"Written: {a.out}"])


def apply(a: argparse.Namespace, reporter: Reporter) -> None:
    """Puts a preset on a scene, renders it before and after, and saves it."""
    look = library.named(a.preset)
    with Outputs(a.out) as out:
        scene, choice, _ = _open(a, reporter)
        sight = scene_io.open_sight(scene, choice)
        survey, found = sight.survey, preset_fit.fit(look, sight)
        if not found.values:
            raise schema.VibeError("Nothing in this scene takes what the preset holds.", "Use another scene.")
        reporter.stage("rendering before")
        rendering.render(scene, out.path("before.png"), a.size, a.samples, a.seed)
        skipped = bindings.write(scene, found.values, survey.objects, survey.pivot)
        reporter.stage("rendering after")
        _render_after(scene, survey, a, out)
        save_blend(out.path("vibed.blend"))
    lines = [f"Did not fit: {line}" for line in found.rest]
    lines += [f"Did not fit: {changes.title(key)}: {reason}" for key, reason in skipped.items()]
    count = len(found.values) - len(skipped)
    reporter.result(
        [f"{count} values of the preset fit this scene.", *_listed(sight.instances, found.values), *lines]
    )


def revert(a: argparse.Namespace, reporter: Reporter) -> None:
    """Takes every vibe out of a .blend, which is written in place."""
    if a.scene:
        _open_blend(Path(a.scene))
    path = Path(bpy.data.filepath)
    scenes = [scene for scene in bpy.data.scenes if snapshot.exists(scene)]
    if not scenes:
        raise schema.VibeError(
            f"{path.name} holds no vibe to revert.", "Only a vibed .blend can be reverted."
        )
    lost = [line for scene in scenes for line in snapshot.revert(scene)]
    with Outputs(path.parent) as out:
        save_blend(out.path(path.name))
    reporter.result([f"{path.name} is as it was before.", *(f"Could not restore: {line}" for line in lost)])


def frames(a: argparse.Namespace, reporter: Reporter) -> None:
    """Renders frames of a .blend as it stands, with Cycles, to OUT/0001.png and so on; those that are there stay."""
    scene, _, _ = _open(a, reporter)
    first, _, last = (a.frames or f"{scene.frame_start}-{scene.frame_end}").partition("-")
    for number in range(int(first), int(last or first) + 1):
        path = a.out / f"{number:04}.png"
        if not path.exists():
            reporter.stage(f"rendering frame {number}")
            scene.frame_set(number)
            rendering.render_final(scene, path)
    reporter.result([f"Written: {a.out}"])


COMMANDS: dict[str, Callable[[argparse.Namespace, Reporter], None]] = {
    "run": vibe,
    "demo": vibe,
    "export": export,
    "apply": apply,
    "revert": revert,
    "frames": frames,
}


def _open(a: argparse.Namespace, reporter: Reporter) -> tuple[bpy.types.Scene, Choice, bool]:
    """The scene, how its subject is chosen, and whether it is a bare mesh that we have staged."""
    path = Path(a.scene).expanduser().absolute() if a.scene else None
    chosen = tuple(a.subject)
    if a.command == "demo" or a.demo:
        reporter.stage("building the demo scene")
        return demo.build_demo(), Choice(chosen or (demo.SUBJECT,)), False
    if path and path.suffix.lower() in stage.FORMATS:
        reporter.stage(f"staging {path.name}")
        scene = stage.build_stage(path, a.stage)
        return scene, Choice(chosen, selected=not chosen), True
    if path:
        reporter.stage(f"opening {path.name}")
        _open_blend(path)
    return bpy.context.scene, Choice(chosen), False


def _open_blend(path: Path) -> None:
    """Opens a .blend, without running scripts in it."""
    if not path.is_file():
        raise schema.VibeError(f"There is no file {path}.", "Check the path.")
    try:
        bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    except RuntimeError as error:
        reason = str(error).strip().splitlines()[-1].removeprefix("Error: ").rstrip(".")
        raise schema.VibeError(
            f"{path.name} cannot be opened: {reason}.", "Check that it is a .blend."
        ) from error


def _render_after(scene: bpy.types.Scene, survey: Survey, a: argparse.Namespace, out: Outputs) -> None:
    rendering.render(scene, out.path("after.png"), a.size, a.samples, a.seed)
    rendering.render_mask(scene, out.path("mask.png"), a.size, survey.objects)


def _write_variants(out: Outputs, a: argparse.Namespace, job: Job, found: messages.Result) -> None:
    """A preset of every variant, and the sheet to choose from."""
    for number, variant in enumerate(found.variants, start=1):
        look = presets.extract(a.prompt, job, variant.values, f"{number}: {a.prompt}")
        out.write_text(f"preset-{number}.json", look.dumps())
    if found.variants:
        shutil.copyfile(Path(job.folder) / messages.VARIANTS, out.path(messages.VARIANTS))


def save_blend(path: Path) -> None:
    """Saves the open file under another name; its paths stay right for that folder."""
    try:
        bpy.ops.wm.save_as_mainfile(filepath=str(path), copy=True, relative_remap=True, check_existing=False)
    except RuntimeError as error:
        raise schema.VibeError(f"{path.name} cannot be saved: {error}", "Choose another --out.") from error


def _report(
    a: argparse.Namespace,
    job: Job,
    found: messages.Result,
    measured: messages.Finished,
    skipped: dict[str, str],
    laps: _Laps,
) -> dict[str, Any]:
    """The fields of report.json: the engine's, and ours."""
    report = dict(found.report)
    timings = {**laps.seconds, **{f"engine: {k}": v for k, v in report.pop("timings", {}).items()}}
    versions = {**report.pop("versions", {}), "blender": bpy.app.version_string}
    return {
        **report,
        "prompt": a.prompt,
        "scene": os.path.basename(a.scene or bpy.data.filepath) or a.command,
        "subject": [thing.name_full for thing in job.survey.objects],
        "similarity": measured.similarity,
        "delta_e": measured.delta_e,
        **({"judge": measured.judge} if measured.judge else {}),
        "stopped": found.stopped,
        "not_written": skipped,
        "delta_e_others": measured.others,
        "warnings": _warnings(job, found),
        "timings": {**timings, "total": round(sum(laps.seconds.values()), 2)},
        "versions": versions,
    }


def _warnings(job: Job, found: messages.Result) -> list[str]:
    """What the prediction lacks, in words for the artist."""
    return [*job.warnings, *found.report.get("anchored", {}).get("notes", [])]


def _summary(
    job: Job, found: messages.Result, measured: messages.Finished, skipped: dict[str, str]
) -> list[str]:
    values = {k: v for k, v in found.values.items() if k not in skipped}
    near, s = measured.delta_e, measured.similarity
    lines = [f"Note: {warning}" for warning in [*word_notes(found.report)[:6], *_warnings(job, found)[:4]]]
    lines += _listed(job.instances, values)
    if found.variants:
        lines.append(
            f"{len(found.variants)} variants on variants.png; `vibe apply preset-2.json` takes the second."
        )
    return [
        *lines,
        *model_lines(found.report, measured.judge),
        f"Similarity to the words {s['before']:.3f} -> {s['after']:.3f}; "
        f"the prediction is {near:.1f} CIEDE2000 away from Cycles.",
    ]


def _listed(instances: dict[str, schema.Instance], values: dict[str, Any]) -> list[str]:
    """The changes that show, as lines; the largest on the perceptual scale first."""
    rows = []
    for key, value in values.items():
        instance = instances.get(key)
        if instance is None:  # of a light that has been added
            continue
        before, after = instance.value, tuple(value)
        if changes.same(key, before, after):
            continue
        ends = zip(before, after, instance.lower, instance.upper, strict=True)
        unit = instance.parameter.scale.to_unit
        distance = max(abs(unit(x, low, high) - unit(y, low, high)) for x, y, low, high in ends)
        line = f"{changes.title(key)}: {changes.text(key, before)} -> {changes.text(key, after)}"
        rows.append((distance, line))
    rows.sort(reverse=True)
    more = [f"... and {len(rows) - _SHOWN} more"] if len(rows) > _SHOWN else []
    return [line for _, line in rows[:_SHOWN]] + more


class _Laps:
    """A stopwatch: `seconds` by the name of the lap."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.monotonic()

    def lap(self, name: str) -> None:
        now = time.monotonic()
        self.seconds[name] = round(now - self._last, 2)
        self._last = now
