# SPDX-License-Identifier: GPL-3.0-or-later
"""Stands for the program `blender` where there is only the bpy package: the arguments that a farm's worker gives it."""

import runpy
import sys
from pathlib import Path

import bpy

FLAGS = {"-b", "-y", "--background", "--enable-autoexec"}


def main(arguments):
    own = arguments[: arguments.index("--")] if "--" in arguments else list(arguments)
    while own:
        word = own.pop(0)
        scene = bpy.context.scene
        if word in FLAGS:
            continue
        if word == "--python-exit-code":
            own.pop(0)
        elif word == "--python":
            runpy.run_path(own.pop(0), run_name="__main__")
        elif word == "--render-output":
            scene.render.filepath = own.pop(0)
        elif word == "--render-format":
            scene.render.image_settings.file_format = own.pop(0)
        elif word == "--render-frame":
            first, _, last = own.pop(0).partition("..")
            pattern = scene.render.filepath
            for frame in range(int(first), int(last or first) + 1):
                scene.frame_set(frame)
                scene.render.filepath = pattern.replace("######", f"{frame:06}")
                bpy.ops.render.render(write_still=True)
        else:
            assert Path(word).suffix == ".blend", word
            bpy.ops.wm.open_mainfile(filepath=word)


if __name__ == "__main__":
    main(sys.argv[1:])
