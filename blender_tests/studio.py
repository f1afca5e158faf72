# SPDX-License-Identifier: GPL-3.0-or-later
"""A ball on a floor in a small studio, rendered by Cycles with any values: what measures of pictures are tried on."""

import bpy
import numpy as np
from vibe_render.export import reading
from vibe_render.render import final_render
from vibe_render.scene import bindings
from vibe_render.scene.stage import area_light, floor, framing_camera, plain_material, plain_world
from vibe_render.scene.subject import SubjectChoice

from lab.bench.paper import finished
from lab.blender.camera_hits import save_camera_hits
from lab.blender.clear import render_clear
from lab.blender.scenes import making

SIZE, SAMPLES = 96, 16


class Studio:
    """A ball on a floor before a row of posts; `shoot` renders it with other values, by key."""

    def __init__(self, folder):
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, load_ui=False)
        self.folder, self.scene = folder, bpy.context.scene
        self.scene.render.resolution_x = self.scene.render.resolution_y = SIZE
        ball = making.ball("Ball", 0.9, (0.0, 0.0, 0.9))
        ball.data.materials.append(plain_material("Ball", (0.35, 0.12, 0.1), roughness=0.4))
        stone = plain_material("Stone", (0.3, 0.3, 0.3), roughness=0.9)
        floor(self.scene, 40.0, stone)
        for i in range(6):
            post = making.ball(f"Post {i}", 0.5, (-6.0 + 2.4 * i, 7.0, 0.8), 12)
            post.data.materials.append(stone)
        corners = np.array([(-1.1, 0, 0), (1.1, 0, 2.0)])
        pivot = np.array([0.0, 0.0, 0.9])
        framing_camera(self.scene, corners, (0.0, 12.0), fov=38.0, fill=0.6, pivot=pivot)
        area_light(self.scene, "Key", (-50.0, 40.0), 5.0, 0.6, 0.7, pivot)
        plain_world(self.scene, (0.4, 0.4, 0.4), strength=0.4)
        self.job = reading.export_scene(self.scene, folder / "job", SubjectChoice(("Ball",)))
        self.start = {key: tuple(i.value) for key, i in self.job.instances.items()}

    def shoot(self, clear=False, **values):
        """The picture at these values; names have "__" for the slash."""
        wanted = {key.replace("__", "/"): (v if isinstance(v, tuple) else (v,)) for key, v in values.items()}
        left = bindings.write(self.scene, self.start | wanted, self.job.analysis.objects, self.job.analysis.pivot)
        assert not [key for key in left if key in wanted], left
        for old in self.folder.glob("*.png"):
            old.unlink()
        final_render.render_picture(self.scene, self.folder / "after.png", SIZE, SAMPLES)
        if clear:
            render_clear(self.scene, self.folder / "clear.png", SIZE, SAMPLES)
        final_render.render_mask(self.scene, self.folder / "mask.png", SIZE, self.job.analysis.objects)
        save_camera_hits(self.job.analysis, self.folder / "after.npz", SIZE)
        return finished.load(self.folder, "after")
