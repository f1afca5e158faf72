# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments without a window: a vibe at each of several frames, and keyframes of their values in one .blend."""

from __future__ import annotations

import argparse
import json
import re
import tempfile
from copy import copy
from itertools import pairwise
from pathlib import Path
from typing import Any

from mathutils import Vector

from ..core import rendered
from ..core.files import Outputs
from ..core.schema_import import checks, schema
from ..engine.process import Engine
from ..export import reading
from ..render import final_render
from ..run.notes import words_of
from ..scene import bindings, fog, moments, scene_context
from ..scene.moments import Moment
from ..scene.steps import Steps, origins
from .arguments import Reporter
from .scenes import Framing, open_scene, save_blend
from .summary import numbered
from .vibe import HeadlessVibe, run_one

STRIP = "moments.png"
_UNNAMED = re.compile(r"F_\d+")  # Blender's own name for a marker
_TILE, _TILE_SAMPLES = 256, 16  # of each image of the strip: longer side in pixels, and samples
_STEPS = 3  # images of the strip for each interval between two moments


def run(args: argparse.Namespace, reporter: Reporter, engine: Engine) -> None:
    """Finds the look of each moment, always starting from the artist's own scene, and writes all into one .blend.

    Nothing is written if fewer than two moments are given, or if any vibe fails.
    """
    queue = list(args.moments) or _of_markers(args, reporter)
    count = len(queue)
    found: list[Moment] = []
    rows: list[dict[str, Any]] = []  # for each moment, the report of its vibe, its frame and its image files
    with Outputs(args.out) as out, tempfile.TemporaryDirectory(prefix="vibe-") as folder:
        while queue:
            frame, prompt = queue.pop(0)
            each, number = copy(args), len(found)
            each.prompt, each.frames, each.out = prompt, [frame], Path(folder, str(number))
            each.out.mkdir()
            reporter.note(f"Moment {number + 1} of {count}: frame {frame}, {prompt}")
            analysis = run_one(HeadlessVibe(each, reporter, engine), queue)
            steps, names = Steps.of(analysis.scene), [o.name_full for o in analysis.objects]
            found.append(Moment(frame, prompt, steps.values(), steps.base, steps.pivot, names))
            report = json.loads((each.out / "report.json").read_text(encoding="utf-8"))
            before, after = numbered("before.png", number), numbered("after.png", number)
            rows.append({"frame": frame, "before": before, "after": after, **report})
            out.copy(before, each.out / "before.png")
        notes = _write(args, reporter, out, found)
        out.write_json("report.json", {"moments": rows, "left_alone": notes})
    lines, missing = [f"Note: {note}" for note in notes], []
    for moment, row in zip(found, rows, strict=True):
        missed = words_of(row["verdicts"], "missed")
        note = f" Not visible: {', '.join(missed)}." if missed else ""
        lines.append(f"Frame {moment.frame}: {moment.prompt}.{note}")
        missing += missed
    lines.append(f"Keyframes from frame {found[0].frame} to {found[-1].frame}. {STRIP} shows the way.")
    reporter.result(lines, any(row["stopped"] for row in rows), missing)


def _of_markers(args: argparse.Namespace, reporter: Reporter) -> list[tuple[int, str]]:
    """(frame, name) of the scene's markers, by frame; without markers that have Blender's default names."""
    scene, _, _ = open_scene(args, reporter)
    named = [(m.frame, m.name) for m in scene.timeline_markers if not _UNNAMED.fullmatch(m.name)]
    if not named:
        remedy = "Name markers in the timeline after looks, such as noon, or use --moments."
        raise schema.VibeError(f"{Path(args.scene).name} has no marker with a look as its name.", remedy)
    return checks.in_order(sorted(named))


def _write(args: argparse.Namespace, reporter: Reporter, out: Outputs, found: list[Moment]) -> list[str]:
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
        final_render.join_pictures(tiles, out.path(STRIP))
    framing.restore()
    save_blend(out.path("vibed.blend"))
    return notes
