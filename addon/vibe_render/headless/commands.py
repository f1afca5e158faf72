# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands of a headless run: run, export, apply, revert, frames, and `serve`, which runs many command lines."""

import json
import os
import queue
import re
import sys
import tempfile
import threading
from argparse import Namespace
from collections.abc import Callable
from copy import copy
from itertools import pairwise
from pathlib import Path
from typing import Any

import bpy
from mathutils import Vector

from ..core import rendered
from ..core.files import Outputs
from ..core.schema_import import checks, errors, labels, schema
from ..engine.process import Engine
from ..export import reading
from ..looks import library, transfer
from ..render import final_render
from ..run.notes import lost_frames, words_of
from ..scene import bindings, fog, moments, scene_context, snapshot
from ..scene.moments import Moment
from ..scene.steps import Steps, origins
from ..scene.subject import remember_subject
from . import summary
from .arguments import Reporter, parse
from .scenes import Framing, open_blend, open_scene, save_blend
from .summary import numbered
from .vibe import HeadlessVibe, run_one

_GRACE = 5.0  # seconds after the end of the input until a process that is still busy is ended
_STRIP = "moments.png"
_UNNAMED = re.compile(r"F_\d+")  # Blender's own name for a marker
_TILE, _TILE_SAMPLES = 256, 16  # of each image of the strip: longer side in pixels, and samples
_STEPS = 3  # images of the strip for each interval between two moments


def run(args: Namespace, reporter: Reporter) -> None:
    """Runs a vibe or moments (looks at several frames), if requested, and then the further sentences (`--then`)."""
    engine = Engine(args.engine, listener=reporter.engine)
    engine.start()  # before the scene is opened: both load at the same time
    shown = None  # the newest render of the scene that is to be opened next
    try:
        has_look = args.prompt.strip() or args.like or args.goals or not args.then
        if args.moments or args.markers:
            _run_moments(args, reporter, engine)
        elif has_look:
            first = HeadlessVibe(args, reporter, engine)
            analysis = run_one(first, args.then)
            if args.steady and (lost := lost_frames(first.sequence)):
                reporter.stage(f"searching one look for frames {', '.join(map(str, lost))} too")
                steady = copy(args)
                steady.frames, steady.check_every = [analysis.scene.frame_current, *lost], 0
                run_one(HeadlessVibe(steady, reporter, engine), [])
        for number, sentence in enumerate(args.then):
            if number or has_look:  # go on with the .blend that was written
                args, shown = copy(args), args.out / "after.png"
                args.scene, args.command = str(args.out / "vibed.blend"), "run"
                args.scenes = [args.scene]
            go_on(args, sentence, reporter, engine, shown)
    except BaseException:
        engine.stop(patience=0.1)  # it may be busy
        raise
    engine.stop()


def go_on(args: Namespace, sentence: str, reporter: Reporter, engine: Engine, shown: Path | None = None) -> None:
    """Runs a further sentence; raises VibeError if the scene has no look. `shown`: the last step's render, or None."""
    scene, _, _ = open_scene(args, reporter)
    steps = Steps.of(scene)
    if not snapshot.exists(scene):
        name = os.path.basename(args.scene or bpy.data.filepath)
        raise schema.VibeError(f"{name} has no look to go on from.", "Give it one first, with --prompt.")
    steps.take_hand_made(current := bindings.read(scene, (), steps.pivot))
    change = steps.change(sentence)
    if change.sentence:
        args = copy(args)
        args.prompt, args.like, args.goals, args.like_only, args.variants = change.sentence, "", "", [], 1
        args.target = args.target if change.first else []
        as_it_is = None if change.values else shown  # values that are written first change the image
        run_one(HeadlessVibe(args, reporter, engine, change, as_it_is), args.then)
        return
    with Outputs(args.out) as out:
        skipped = bindings.write(scene, change.values, (), steps.pivot)
        steps.add(change, current, {})
        steps.store(scene)
        reporter.stage("rendering with Cycles")
        lights = out.path("lights.exr") if args.light_mix else None
        after = out.path("after.png")
        layers = final_render.render_picture(scene, after, args.size, args.samples, args.seed, lights=lights)
        out.copy(f"step-{steps.shown}.png", after)
        report = {"prompt": sentence, "steps": steps.rows(), "not_written": skipped}
        rows = summary.light_rows("lights.exr", layers)
        out.write_json("report.json", report | ({"lights": rows} if rows else {}))
        save_blend(out.path("vibed.blend"))
    reporter.result([f"The scene shows step {steps.shown} of {len(steps.steps)}."])


def _run_moments(args: Namespace, reporter: Reporter, engine: Engine) -> None:
    """Finds the look of each moment (a frame), starting from the artist's own scene, and writes all into one .blend.

    Nothing is written if fewer than two moments are given, or if any vibe fails.
    """
    waiting = list(args.moments)
    if not waiting:  # names of markers are the looks, without Blender's own names
        scene, _, _ = open_scene(args, reporter)
        named = [(m.frame, m.name) for m in scene.timeline_markers if not _UNNAMED.fullmatch(m.name)]
        if not named:
            remedy = "Name markers in the timeline after looks, such as noon, or use --moments."
            raise schema.VibeError(f"{Path(args.scene).name} has no marker with a look as its name.", remedy)
        waiting = checks.in_order(sorted(named))
    count = len(waiting)
    found: list[Moment] = []
    rows: list[dict[str, Any]] = []  # for each moment, the report of its vibe, its frame and its image files
    with Outputs(args.out) as out, tempfile.TemporaryDirectory(prefix="vibe-") as folder:
        while waiting:
            frame, prompt = waiting.pop(0)
            each, number = copy(args), len(found)
            each.prompt, each.frames, each.out = prompt, [frame], Path(folder, str(number))
            each.out.mkdir()
            reporter.note(f"Moment {number + 1} of {count}: frame {frame}, {prompt}")
            analysis = run_one(HeadlessVibe(each, reporter, engine), waiting)
            steps, names = Steps.of(analysis.scene), [o.name_full for o in analysis.objects]
            found.append(Moment(frame, prompt, steps.values(), steps.base, steps.pivot, names))
            report = json.loads((each.out / "report.json").read_text(encoding="utf-8"))
            before, after = numbered("before.png", number), numbered("after.png", number)
            rows.append({"frame": frame, "before": before, "after": after, **report})
            out.copy(before, each.out / "before.png")
        notes = _write_moments(args, reporter, out, found)
        out.write_json("report.json", {"moments": rows, "left_alone": notes})
    lines, missing = [f"Note: {note}" for note in notes], []
    for moment, row in zip(found, rows, strict=True):
        missed = words_of(row["verdicts"], "missed")
        note = f" Not visible: {', '.join(missed)}." if missed else ""
        lines.append(f"Frame {moment.frame}: {moment.prompt}.{note}")
        missing += missed
    lines.append(f"Keyframes from frame {found[0].frame} to {found[-1].frame}. {_STRIP} shows the way.")
    reporter.result(lines, any(row["stopped"] for row in rows), missing)


def _write_moments(args: Namespace, reporter: Reporter, out: Outputs, found: list[Moment]) -> list[str]:
    """Writes keyframes into the artist's scene, renders and saves it; returns notes on values that were left alone."""
    scene, choice, _ = open_scene(args, reporter)
    framing, camera = Framing(scene), "".join(args.cameras)
    reading.prepare_and_snapshot(scene, choice)

    def show(frame: int) -> None:
        framing.show(camera, frame)
        rendered.layer(scene).update()

    eyes, named = [], {each for moment in found for key in moment.values for each in origins(key)}
    for moment in found:
        show(moment.frame)
        eyes.append(scene.camera.matrix_world.translation.copy())
        own = bindings.read(scene, (), moment.pivot)
        moment.base |= {key: list(own[key]) for key in named if key in own}
    subject = [scene.objects[name] for name in found[0].subject if name in scene.objects]
    context = scene_context.SceneContext(scene, subject, Vector(found[0].pivot))
    fog.plan_fog_box(scene, fog.fog_domain(context, eyes))
    reporter.stage("writing keyframes")
    notes = moments.show(scene, found)
    reporter.stage("rendering with Cycles")
    for number, moment in enumerate(found):
        show(moment.frame)
        after = out.path(numbered("after.png", number))
        final_render.render_picture(scene, after, args.size, args.samples, args.seed)
    with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
        # The strip's images are the moments, and `_STEPS` - 1 frames between each two.
        at = [moment.frame for moment in found]
        between = [a + round(n * (b - a) / _STEPS) for a, b in pairwise(at) for n in range(_STEPS)]
        tiles = []
        for frame in sorted({*between, *at}):
            show(frame)
            tiles.append(Path(folder, f"{frame}.png"))
            final_render.render_picture(scene, tiles[-1], _TILE, _TILE_SAMPLES, args.seed)
        final_render.join_pictures(tiles, out.path(_STRIP))
    framing.restore()
    save_blend(out.path("vibed.blend"))
    return notes


def export(args: Namespace, reporter: Reporter) -> None:
    """Exports a scene to the job folder `args.out`, without changing the scene's file."""
    scene, choice, _ = open_scene(args, reporter)
    reporter.stage("reading the scene")
    reading.export_scene(scene, args.out, choice, measure=not args.names_only)
    reporter.result([f"Written: {args.out}"])


def apply(args: Namespace, reporter: Reporter) -> None:
    """Applies a preset to a scene, renders the scene before and after, and saves it to the output folder."""
    look = library.preset_named(args.preset)
    with Outputs(args.out) as out:
        scene, choice, _ = open_scene(args, reporter)
        scene_reading = reading.prepare_and_read(scene, choice)
        analysis, fitted = scene_reading.analysis, transfer.fit_look(look, scene_reading)
        if not fitted.values:
            raise schema.VibeError("Nothing in this scene takes what the preset holds.", "Use another scene.")
        reporter.stage("rendering before")
        final_render.render_picture(scene, out.path("before.png"), args.size, args.samples, args.seed)
        skipped = bindings.write(scene, fitted.values, analysis.objects, analysis.pivot)
        remember_subject(scene, analysis.objects, choice)
        reporter.stage("rendering after")
        final_render.render_picture(scene, out.path("after.png"), args.size, args.samples, args.seed)
        save_blend(out.path("vibed.blend"))
    lines = [f"Did not fit: {line}" for line in fitted.rest]
    lines += [f"Did not fit: {labels.title(key)}: {reason}" for key, reason in skipped.items()]
    count = len(fitted.values) - len(skipped)
    listed = summary.change_lines(scene_reading.instances, fitted.values)
    reporter.result([f"{count} values of the preset fit this scene.", *listed, *lines])


def revert(args: Namespace, reporter: Reporter) -> None:
    """Reverts every vibe of a .blend, and saves the file in place."""
    if args.scene:
        open_blend(Path(args.scene))
    path = Path(bpy.data.filepath)
    scenes = [scene for scene in bpy.data.scenes if snapshot.exists(scene)]
    if not scenes:
        raise schema.VibeError(f"{path.name} holds no vibe to revert.", "Only a vibed .blend can be reverted.")
    if not os.access(path, os.W_OK):  # replacing a file does not need write permission for it
        raise schema.VibeError(f"{path.name} is read-only.", "Make it writable, or copy it to where it can be changed.")
    lost = [line for scene in scenes for line in snapshot.revert(scene)]
    with Outputs(path.parent) as out:
        save_blend(out.path(path.name))
    reporter.result([f"{path.name} is as it was before.", *(f"Could not restore: {line}" for line in lost)])


def frames(args: Namespace, reporter: Reporter) -> None:
    """Renders frames of a .blend with Cycles to OUT/0001.png and so on; existing pictures are skipped.

    The camera is the first of `--cameras`, or the scene's own, which camera markers may switch.
    """
    args.out.mkdir(parents=True, exist_ok=True)
    scene, _, _ = open_scene(args, reporter)
    Framing(scene).show(*args.cameras[:1])
    for number in args.frames or range(scene.frame_start, scene.frame_end + 1):
        path = args.out / f"{number:04}.png"
        if not path.exists():
            reporter.stage(f"rendering frame {number}")
            scene.frame_set(number)
            final_render.render_final(scene, path)
    reporter.result([f"Written: {args.out}"])


COMMANDS: dict[str, Callable[[Namespace, Reporter], None]] = {
    "run": run, "demo": run, "export": export, "apply": apply, "revert": revert, "frames": frames,
}  # fmt: skip


def serve() -> None:
    """Runs command lines, one after the other, with one engine that stays loaded; `vibe batch` starts such processes.

    Each line of the standard input is a command line of `batch.py`, as a JSON list, and is answered by a "result" or an
    "error" event. When the input ends, the process ends too: at most `_GRACE` seconds later if a command is running.
    """
    lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()

    def listen() -> None:
        for line in sys.stdin:
            lines.put(line)
        lines.put(None)
        threading.Event().wait(_GRACE)
        os._exit(1)  # Blender is still busy

    threading.Thread(target=listen, daemon=True).start()
    reporter = Reporter(events=True)
    engine = Engine(listener=reporter.engine)
    engine.start()
    try:
        while line := lines.get():
            try:
                engine.start()  # a new process if the engine died, or was stopped after an error
                args = parse(json.loads(line))
                if args.command == "run":
                    HeadlessVibe(args, reporter, engine).run()
                else:
                    COMMANDS[args.command](args, reporter)
            except Exception as error:  # go on: the next command opens another file
                reporter.error(errors.to_show(error, reporter.doing))
                engine.stop(patience=0.1)  # it may be in the middle of something
    finally:
        engine.stop()
