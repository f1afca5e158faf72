# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a .blend with EEVEE, ray tracing on, in a Blender that has a window.

    blender --python eevee.py -- SIZE FRAMES FILE.blend

The picture is written beside the file as eevee.png. The time of every frame is printed; the first one compiles shaders.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import bpy

if not __package__:
    here = Path(__file__).resolve()
    root = here.parents[2]
    sys.path += [str(root / "addon"), str(root)]  # last: Blender has packages of its own

from vibe_render.core import compat
from vibe_render.core.compat import changed


def render(path: Path, size: int, frames: int) -> None:
    """Opens a file and renders it with EEVEE to `eevee.png` beside it.

    Args:
        size: Side of the square picture, pixels.
    """
    bpy.ops.wm.open_mainfile(filepath=str(path), load_ui=False, use_scripts=False)
    scene = bpy.context.scene
    picture = scene.render.image_settings
    scene.eevee.use_raytracing = True
    with (
        changed(scene.render, engine=compat.EEVEE, resolution_x=size, resolution_y=size),
        changed(scene.render, resolution_percentage=100, filepath=str(path.with_name("eevee.png"))),
        changed(picture, media_type="IMAGE"),
        changed(picture, file_format="PNG", color_depth="8"),
        changed(picture, color_mode="RGBA" if scene.render.film_transparent else "RGB"),
    ):
        for _ in range(frames):
            began = time.perf_counter()
            bpy.ops.render.render(write_still=True)
            print(f"EEVEE frame, ms: {1000 * (time.perf_counter() - began):.0f}", flush=True)


if __name__ == "__main__":
    side, count, file = sys.argv[sys.argv.index("--") + 1 :]
    render(Path(file), int(side), int(count))
    bpy.ops.wm.quit_blender()
