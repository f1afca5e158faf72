# SPDX-License-Identifier: GPL-3.0-or-later
"""Further sentences without a window: each goes on from the .blend that the one before has written."""

from __future__ import annotations

import argparse
import os
from copy import copy

import bpy

from ..core.files import Outputs
from ..core.schema_import import schema
from ..engine.process import Engine
from ..render import final_render
from ..scene import bindings, snapshot
from ..scene.steps import Steps
from . import moments, summary
from .arguments import Reporter
from .scenes import open_scene, save_blend
from .vibe import HeadlessVibe, run_one


def run(args: argparse.Namespace, reporter: Reporter) -> None:
    """Runs a vibe, if one is asked for, and the sentences that follow it, with an engine of its own."""
    engine = Engine(args.engine, listener=reporter.engine)
    engine.start()  # first, so that engine and scene load at the same time
    try:
        if args.moments or args.markers:
            moments.run(args, reporter, engine)
        elif args.prompt.strip() or args.like or args.goals or not args.then:
            run_one(HeadlessVibe(args, reporter, engine), args.then)
            args = _written(args)
        for sentence in args.then:
            go_on(args, sentence, reporter, engine)
            args = _written(args)
    except BaseException:
        engine.stop(patience=0.1)  # it may be busy
        raise
    engine.stop()


def _written(args: argparse.Namespace) -> argparse.Namespace:
    """The command line for the .blend that it has written."""
    args = copy(args)
    args.scene, args.command, args.demo = str(args.out / "vibed.blend"), "run", False
    args.scenes = [args.scene]
    return args


def go_on(args: argparse.Namespace, sentence: str, reporter: Reporter, engine: Engine) -> None:
    """Runs a further sentence; a VibeError if the scene has no look, or the sentence says nothing."""
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
        run_one(HeadlessVibe(args, reporter, engine, change), args.then)
        return
    with Outputs(args.out) as out:
        skipped = bindings.write(scene, change.values, (), steps.pivot)
        steps.add(change, current, {})
        steps.store(scene)
        reporter.stage("rendering with Cycles")
        lights = out.path("lights.exr") if args.light_mix else None
        layers = final_render.render_picture(
            scene, out.path("after.png"), args.size, args.samples, args.seed, lights=lights
        )
        out.copy(f"step-{steps.shown}.png", out.path("after.png"))
        report = {"prompt": sentence, "steps": steps.rows(), "not_written": skipped}
        rows = summary.light_rows("lights.exr", layers)
        out.write_json("report.json", report | ({"lights": rows} if rows else {}))
        save_blend(out.path("vibed.blend"))
    reporter.result([f"The scene shows step {steps.shown} of {len(steps.steps)}."])
