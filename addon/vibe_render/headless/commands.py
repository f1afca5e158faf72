# SPDX-License-Identifier: GPL-3.0-or-later
"""The commands that need a scene: vibe it, put a preset on it, revert it."""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import bpy

from ..core.outputs import Outputs
from ..core.schema_import import labels, messages, schema
from ..engine.conversation import Conversation, on_interrupt
from ..engine.process import Engine
from ..export import jobs
from ..export.analysis import Survey
from ..looks import fit, library, take
from ..render import anchors, final_render
from ..scene import bindings, snapshot, stored_subject
from ..session import preferences
from . import summary
from .arguments import engine_options
from .report import Reporter
from .scenes import check_writable, open_blend, open_scene, save_blend
from .shots import Framing, Reel, Shot
from .summary import Laps, numbered

Values = dict[str, Any]


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
    laps = Laps()
    temporary = tempfile.TemporaryDirectory(prefix="vibe-", ignore_cleanup_errors=True)
    with temporary as folder, Outputs(a.out) as out:
        reel = Reel(a, Path(folder), reporter)
        reel.export()
        laps.lap("open and export")
        talk.ask(_request(a, reel))
        for number in reversed(range(len(reel))):  # the last one is still open
            _render(a, reel, number, out, "before.png")
        laps.lap("render before")
        found = talk.wait(messages.Result, lambda request: _anchor(request, reel, reporter))
        laps.lap("wait for the engine")
        measured, skipped = _finish(a, reel, found, talk, out, reporter, laps)
        out.write_json("report.json", summary.report(a, reel, found, measured, skipped, laps))
    reporter.result(summary.summary(reel, found, measured, skipped), found.stopped)
    return reel.jobs[-1].survey


def _request(a: argparse.Namespace, reel: Reel) -> messages.Vibe:
    """What the engine is asked for."""
    several = len(reel) > 1
    shots = [
        messages.Shot(str(job.folder), shot.name, shot.scene)
        for job, shot in zip(reel.jobs, reel.shots, strict=True)
    ]
    free_camera = reel.bare and not several
    options = engine_options(a, free_camera=free_camera, online=preferences.online())
    return messages.Vibe(
        schema.schema_hash(), shots[0].job, a.prompt, asdict(options), shots=shots if several else []
    )


def _anchor(request: messages.Anchor, reel: Reel, reporter: Reporter) -> messages.Anchored:
    """Renders what the engine corrects itself by."""
    name = reel.shots[request.shot].name
    reporter.stage(f"rendering anchor {request.number}{f', {name}' if name else ''}")
    job = reel.show(request.shot)
    found = job.survey
    return anchors.answer(found.scene, job.folder, request, found.objects, found.pivot)


def _render(a: argparse.Namespace, reel: Reel, number: int, out: Outputs, name: str) -> None:
    scene = reel.show(number).survey.scene
    final_render.render(scene, out.path(numbered(name, number)), a.size, a.samples, a.seed)


def _finish(
    a: argparse.Namespace,
    reel: Reel,
    found: messages.Result,
    talk: Conversation,
    out: Outputs,
    reporter: Reporter,
    laps: Laps,
) -> tuple[list[messages.Finished], dict[str, str]]:
    """Writes the values into every shot's scene, renders, measures and saves it.

    Returns:
        Each shot's measures, and what could not be written, with the reason.
    """
    measured: list[messages.Finished] = []
    skipped: dict[str, str] = {}
    for number in range(len(reel)):
        job, family = reel.show(number), reel.siblings(number)
        scene, survey = job.survey.scene, job.survey
        if a.grade_each or number == family[0]:
            values = _values(a, reel, found, number)
            skipped |= bindings.write(scene, values, survey.objects, survey.pivot)
            if reel.choice.explicit:
                stored_subject.remember(scene, survey.objects)
        reporter.stage("rendering with Cycles")
        _render(a, reel, number, out, "after.png")
        final_render.render_mask(scene, out.path(numbered("mask.png", number)), a.size, survey.objects)
        laps.lap("render after")
        pictures = [out.path(numbered(name, number)) for name in ("before.png", "after.png")]
        # Not in `out`, which a failure clears while the engine writes.
        compared = Path(job.folder) / "compare.png"
        pictures.append(compared)
        talk.ask(messages.Finish(*map(str, pictures), shot=number))  # type: ignore[misc, arg-type]
        if number == 0:
            out.write_text("preset.json", take.extract(a.prompt, job, found.values).dumps())
            _write_variants(out, a, reel, found)
        if a.grade_each or number == family[-1]:
            if not a.grade_each:
                reel.restore()
            save_blend(out.path(summary.blend_of(a, reel, number)))
        measured.append(talk.wait(messages.Finished))
        out.copy("compare.png", compared)
        laps.lap("save and measure")
    return measured, skipped


def _values(a: argparse.Namespace, reel: Reel, found: messages.Result, number: int) -> Values:
    """What is written into a shot's scene: also what only the other shots of this .blend show.

    With a grade for each, this shot's own, and not what is left of another's.
    """
    if not found.shots:
        return found.values
    values = {key: value for i in reel.siblings(number) for key, value in found.shots[i].items()}
    if not a.grade_each:
        return values
    film = {key: list(i.value) for key, i in reel.jobs[number].instances.items() if key.startswith("film/")}
    return values | {key: value for key, value in film.items() if key in values} | found.shots[number]


def _write_variants(out: Outputs, a: argparse.Namespace, reel: Reel, found: messages.Result) -> None:
    """A preset of every variant, and the sheet to choose from."""
    job = reel.jobs[0]
    for number, variant in enumerate(found.variants, start=1):
        look = take.extract(a.prompt, job, variant.values, f"{number}: {a.prompt}")
        out.write_text(f"preset-{number}.json", look.dumps())
    if found.variants:
        out.copy(messages.VARIANTS, Path(job.folder) / messages.VARIANTS)


def export(a: argparse.Namespace, reporter: Reporter) -> None:
    """Writes what the engine needs to know of a scene into a folder, and leaves the file alone."""
    scene, choice, _ = open_scene(a, reporter)
    reporter.stage("reading the scene")
    jobs.open_job(scene, a.out, choice)
    reporter.result([f"Written: {a.out}"])


def apply(a: argparse.Namespace, reporter: Reporter) -> None:
    """Puts a preset on a scene, renders it before and after, and saves it."""
    look = library.named(a.preset)
    with Outputs(a.out) as out:
        scene, choice, _ = open_scene(a, reporter)
        sight = jobs.open_sight(scene, choice)
        survey, found = sight.survey, fit.fit(look, sight)
        if not found.values:
            raise schema.VibeError("Nothing in this scene takes what the preset holds.", "Use another scene.")
        reporter.stage("rendering before")
        final_render.render(scene, out.path("before.png"), a.size, a.samples, a.seed)
        skipped = bindings.write(scene, found.values, survey.objects, survey.pivot)
        if choice.explicit:
            stored_subject.remember(scene, survey.objects)
        reporter.stage("rendering after")
        final_render.render(scene, out.path("after.png"), a.size, a.samples, a.seed)
        final_render.render_mask(scene, out.path("mask.png"), a.size, survey.objects)
        save_blend(out.path("vibed.blend"))
    lines = [f"Did not fit: {line}" for line in found.rest]
    lines += [f"Did not fit: {labels.title(key)}: {reason}" for key, reason in skipped.items()]
    count = len(found.values) - len(skipped)
    listed = summary.listed(sight.instances, found.values)
    reporter.result([f"{count} values of the preset fit this scene.", *listed, *lines])


def revert(a: argparse.Namespace, reporter: Reporter) -> None:
    """Takes every vibe out of a .blend, which is written in place."""
    if a.scene:
        open_blend(Path(a.scene))
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


def frames(a: argparse.Namespace, reporter: Reporter) -> None:
    """Renders frames of a .blend as it stands, with Cycles, to OUT/0001.png and so on; those that are there stay.

    Through the camera that is given, or through the scene's own, as its markers say.
    """
    a.out.mkdir(parents=True, exist_ok=True)
    scene, _, _ = open_scene(a, reporter)
    Framing(scene).show(Shot(a.scene, *a.cameras[:1]))
    for number in a.frames or range(scene.frame_start, scene.frame_end + 1):
        path = a.out / f"{number:04}.png"
        if not path.exists():
            reporter.stage(f"rendering frame {number}")
            scene.frame_set(number)
            final_render.render_final(scene, path)
    reporter.result([f"Written: {a.out}"])


COMMANDS: dict[str, Callable[[argparse.Namespace, Reporter], None]] = {
    "run": vibe,
    "demo": vibe,
    "export": export,
    "apply": apply,
    "revert": revert,
    "frames": frames,
}
