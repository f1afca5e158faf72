# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands of a headless run: vibe, export, apply a preset, revert, render frames."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import bpy

from ..core.outputs import Outputs
from ..core.schema_import import command_line, labels, messages, schema
from ..engine.conversation import Conversation, on_interrupt
from ..engine.process import Engine
from ..export import reading
from ..export.analysis import SceneAnalysis
from ..looks import fit, library, take
from ..render import anchors, final_render
from ..scene import bindings, snapshot, stored_subject
from ..session import preferences
from . import summary
from .reporter import Reporter
from .scenes import check_writable, open_blend, open_scene, save_blend
from .shots import Framing, RequestedShot, ShotList
from .summary import Stopwatch, numbered


def vibe(args: argparse.Namespace, reporter: Reporter) -> None:
    """Runs one vibe with an engine of its own, from opening the scene to the saved files."""
    engine = Engine(args.engine)
    engine.start()  # first, so that engine and scene load at the same time
    conversation = Conversation(engine, reporter.engine)
    on_interrupt(conversation.stop)
    try:
        carry_out(args, reporter, conversation)
    except BaseException:
        engine.stop(patience=0.1)  # it may be busy
        raise
    engine.stop()


def carry_out(args: argparse.Namespace, reporter: Reporter, conversation: Conversation) -> SceneAnalysis:
    """Runs one vibe with an engine that is running, and keeps running: another vibe can follow.

    Args:
        args: The command line, from `arguments.parse`.
        reporter: Hears of every stage, and of the result.
        conversation: With the engine.

    Returns:
        What is known about the last shot's scene, which has its new values now.

    Raises:
        VibeError: A mistake in what was asked for, or the engine's error.
    """
    stopwatch = Stopwatch()
    temporary = tempfile.TemporaryDirectory(prefix="vibe-", ignore_cleanup_errors=True)
    with temporary as folder, Outputs(args.out) as out:
        shot_list = ShotList(args, Path(folder), reporter)
        shot_list.export()
        stopwatch.lap("open and export")
        conversation.ask(_request(args, shot_list))
        for number in reversed(range(len(shot_list))):  # the last one is still open
            _render(args, shot_list, number, out, "before.png")
        stopwatch.lap("render before")
        result = conversation.wait(messages.Result, lambda request: _anchor(request, shot_list, reporter))
        stopwatch.lap("wait for the engine")
        measured, skipped = _finish(args, shot_list, result, conversation, out, reporter, stopwatch)
        out.write_json(
            "report.json", summary.report_fields(args, shot_list, result, measured, skipped, stopwatch)
        )
    reporter.result(summary.closing_lines(shot_list, result, measured, skipped), result.stopped)
    return shot_list.jobs[-1].analysis


def _request(args: argparse.Namespace, shot_list: ShotList) -> messages.Vibe:
    """The request for the engine."""
    several = len(shot_list) > 1
    shots = [
        messages.Shot(str(job.folder), shot.name, shot.scene)
        for job, shot in zip(shot_list.jobs, shot_list.shots, strict=True)
    ]
    free_camera = shot_list.bare and not several
    options = command_line.engine_options(args, camera=free_camera, online=preferences.online())
    return messages.Vibe(
        schema.schema_hash(), shots[0].job, args.prompt, asdict(options), shots=shots if several else []
    )


def _anchor(request: messages.Anchor, shot_list: ShotList, reporter: Reporter) -> messages.Anchored:
    """Renders an anchor of one shot."""
    name = shot_list.shots[request.shot].name
    reporter.stage(f"rendering anchor {request.number}{f', {name}' if name else ''}")
    job = shot_list.show(request.shot)
    analysis = job.analysis
    return anchors.answer(analysis.scene, job.folder, request, analysis.objects, analysis.pivot)


def _render(args: argparse.Namespace, shot_list: ShotList, number: int, out: Outputs, name: str) -> None:
    scene = shot_list.show(number).analysis.scene
    final_render.render(scene, out.path(numbered(name, number)), args.size, args.samples, args.seed)


def _finish(
    args: argparse.Namespace,
    shot_list: ShotList,
    result: messages.Result,
    conversation: Conversation,
    out: Outputs,
    reporter: Reporter,
    stopwatch: Stopwatch,
) -> tuple[list[messages.Finished], dict[str, str]]:
    """Writes the values into every shot's scene, renders, measures and saves it.

    Returns:
        The engine's measurements of each shot; and by key, why a value was not written.
    """
    measured: list[messages.Finished] = []
    skipped: dict[str, str] = {}
    for number in range(len(shot_list)):
        job, family = shot_list.show(number), shot_list.siblings(number)
        scene, analysis = job.analysis.scene, job.analysis
        if args.grade_each or number == family[0]:
            values = _values(args, shot_list, result, number)
            skipped |= bindings.write(scene, values, analysis.objects, analysis.pivot)
            if shot_list.choice.explicit:
                stored_subject.remember(scene, analysis.objects)
        reporter.stage("rendering with Cycles")
        _render(args, shot_list, number, out, "after.png")
        final_render.render_mask(scene, out.path(numbered("mask.png", number)), args.size, analysis.objects)
        stopwatch.lap("render after")
        pictures = [out.path(numbered(name, number)) for name in ("before.png", "after.png")]
        # Not into `out`: a failure deletes that while the engine may still write.
        compared = Path(job.folder) / "compare.png"
        pictures.append(compared)
        conversation.ask(messages.Finish(*map(str, pictures), shot=number))  # type: ignore[misc, arg-type]
        if number == 0:
            out.write_text("preset.json", take.extract(args.prompt, job, result.values).dumps())
            _write_variants(out, args, shot_list, result)
        if args.grade_each or number == family[-1]:
            if not args.grade_each:
                shot_list.restore()
            save_blend(out.path(summary.blend_of(args, shot_list, number)))
        measured.append(conversation.wait(messages.Finished))
        out.copy("compare.png", compared)
        stopwatch.lap("save and measure")
    return measured, skipped


def _values(
    args: argparse.Namespace, shot_list: ShotList, result: messages.Result, number: int
) -> dict[str, Any]:
    """The values to write into a shot's scene, with those of the other shots of the same .blend.

    With `--grade-each`, grade and exposure are this shot's own: they replace what an earlier shot has left.
    """
    if not result.shots:
        return result.values
    values = {key: value for i in shot_list.siblings(number) for key, value in result.shots[i].items()}
    if not args.grade_each:
        return values
    film = {
        key: list(i.value) for key, i in shot_list.jobs[number].instances.items() if key.startswith("film/")
    }
    return values | {key: value for key, value in film.items() if key in values} | result.shots[number]


def _write_variants(
    out: Outputs, args: argparse.Namespace, shot_list: ShotList, result: messages.Result
) -> None:
    """Writes a preset of every variant, and their contact sheet."""
    job = shot_list.jobs[0]
    for number, variant in enumerate(result.variants, start=1):
        look = take.extract(args.prompt, job, variant.values, f"{number}: {args.prompt}")
        out.write_text(f"preset-{number}.json", look.dumps())
    if result.variants:
        out.copy(messages.VARIANTS, Path(job.folder) / messages.VARIANTS)


def export(args: argparse.Namespace, reporter: Reporter) -> None:
    """Writes a job folder of a scene; its file stays as it is."""
    scene, choice, _ = open_scene(args, reporter)
    reporter.stage("reading the scene")
    reading.export_scene(scene, args.out, choice)
    reporter.result([f"Written: {args.out}"])


def apply(args: argparse.Namespace, reporter: Reporter) -> None:
    """Puts a preset on a scene, renders it before and after, and saves it."""
    look = library.named(args.preset)
    with Outputs(args.out) as out:
        scene, choice, _ = open_scene(args, reporter)
        scene_reading = reading.prepare_and_read(scene, choice)
        analysis, fitted = scene_reading.analysis, fit.fit(look, scene_reading)
        if not fitted.values:
            raise schema.VibeError("Nothing in this scene takes what the preset holds.", "Use another scene.")
        reporter.stage("rendering before")
        final_render.render(scene, out.path("before.png"), args.size, args.samples, args.seed)
        skipped = bindings.write(scene, fitted.values, analysis.objects, analysis.pivot)
        if choice.explicit:
            stored_subject.remember(scene, analysis.objects)
        reporter.stage("rendering after")
        final_render.render(scene, out.path("after.png"), args.size, args.samples, args.seed)
        final_render.render_mask(scene, out.path("mask.png"), args.size, analysis.objects)
        save_blend(out.path("vibed.blend"))
    lines = [f"Did not fit: {line}" for line in fitted.rest]
    lines += [f"Did not fit: {labels.title(key)}: {reason}" for key, reason in skipped.items()]
    count = len(fitted.values) - len(skipped)
    listed = summary.change_lines(scene_reading.instances, fitted.values)
    reporter.result([f"{count} values of the preset fit this scene.", *listed, *lines])


def revert(args: argparse.Namespace, reporter: Reporter) -> None:
    """Takes every vibe out of a .blend, which is written in place."""
    if args.scene:
        open_blend(Path(args.scene))
    path = Path(bpy.data.filepath)
    scenes = [scene for scene in bpy.data.scenes if snapshot.exists(scene)]
    if not scenes:
        raise schema.VibeError(
            f"{path.name} holds no vibe to revert.", "Only a vibed .blend can be reverted."
        )
    check_writable(path)
    lost = [line for scene in scenes for line in snapshot.revert(scene)]
    with Outputs(path.parent) as out:
        save_blend(out.path(path.name))
    reporter.result([f"{path.name} is as it was before.", *(f"Could not restore: {line}" for line in lost)])


def frames(args: argparse.Namespace, reporter: Reporter) -> None:
    """Renders frames of a .blend with Cycles to OUT/0001.png and so on; existing pictures are skipped.

    The camera is the given one, or the scene's own, as its markers say.
    """
    args.out.mkdir(parents=True, exist_ok=True)
    scene, _, _ = open_scene(args, reporter)
    Framing(scene).show(RequestedShot(args.scene, *args.cameras[:1]))
    for number in args.frames or range(scene.frame_start, scene.frame_end + 1):
        path = args.out / f"{number:04}.png"
        if not path.exists():
            reporter.stage(f"rendering frame {number}")
            scene.frame_set(number)
            final_render.render_final(scene, path)
    reporter.result([f"Written: {args.out}"])


COMMANDS: dict[str, Callable[[argparse.Namespace, Reporter], None]] = {
    "run": vibe,
    "demo": vibe,
    "export": export,
    "apply": apply,
    "revert": revert,
    "frames": frames,
}
