# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the looks that come with Vibe Render, with Vibe Render: one vibe for each prompt of `looks.toml`.

    python -m lab.blender.make_looks [--only NAME] [--effort …] [--out DIR]

What follows is handed to every vibe, as on the command line of `vibe run`. Materials and cameras stay as they are:
these are moods of light, air and film, which fit any scene.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import tomllib
from pathlib import Path

import bpy
import numpy as np
from vibe_render.core.schema_import import preset, schema
from vibe_render.engine.process import Engine
from vibe_render.headless import arguments, scenes, vibe
from vibe_render.headless.arguments import Reporter
from vibe_render.looks import library, thumbnail, transfer
from vibe_render.scene.stage import DEMO_SUBJECT, area_light, build_demo

GROUPS = "light,world,volume,film"
PROMPTS = Path(__file__).with_name("looks.toml")


def main() -> int:
    """Makes all looks, or one; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", default=[], metavar="NAME", help="make these alone")
    parser.add_argument("--out", type=Path, default=library.SHIPPED, metavar="DIR", help="default: %(default)s")
    a, options = parser.parse_known_args()
    rows = tomllib.loads(PROMPTS.read_text(encoding="utf-8"))["look"]
    a.out.mkdir(parents=True, exist_ok=True)
    reporter = Reporter(events=False)
    engine = Engine(listener=reporter.engine)
    engine.start()
    try:
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            for row in rows:
                if not a.only or row["name"] in a.only:
                    make(row["name"], row["prompt"], options, Path(folder), a.out, engine, reporter)
    except schema.VibeError as error:
        reporter.error(error)
        return 2
    finally:
        engine.stop(patience=0.5)
    return 0


def make(
    name: str, prompt: str, options: list[str], folder: Path, out: Path, engine: Engine, reporter: Reporter
) -> None:
    """Makes a look and its picture.

    Args:
        options: More options of `vibe run`.
        folder: For the stage, which all looks share, and the run's files.
        out: Where the preset and its picture go.

    Raises:
        VibeError: As a vibe does.
    """
    print(f"\n{name}: {prompt}", flush=True)
    stage = folder / "stage.blend"
    if not stage.exists():
        build_stage(stage)
    words = ["run", str(stage), f"--prompt={prompt}", f"--groups={GROUPS}", f"--subject={DEMO_SUBJECT}"]
    args = arguments.parse([*words, f"--out={folder}", *options])
    vibe.HeadlessVibe(args, reporter, engine).run()
    look_preset = transfer.load_preset(folder / "preset.json")
    path = library.path_for(out, name)
    thumbnail.save_thumbnail(folder / "after.png", path.with_suffix(thumbnail.SUFFIX))
    path.write_text(preset.Preset(name, look_preset.roles, look_preset.kinds, prompt).dumps() + "\n", encoding="utf-8")


def build_stage(path: Path) -> None:
    """The demo's still life, nearer, with a fill light, so that looks say what all three lights do.

    Its subject is painted: what a look does to colors shows on a color.
    """
    scene = build_demo()
    scene.camera.data.angle *= 0.82
    paint = bpy.data.objects[DEMO_SUBJECT].active_material.node_tree.nodes["Principled BSDF"]
    paint.inputs["Base Color"].default_value = (0.62, 0.16, 0.07, 1.0)
    pivot = np.array([0.0, 0.0, 0.86])
    area_light(scene, "Fill", (80.0, 18.0), 4.5, 3.0, 0.2, pivot)
    scenes.save_blend(path)


if __name__ == "__main__":
    sys.exit(main())
