# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine's film against Blender: the grade group's nodes, and every view transform, on a picture of known light."""

from pathlib import Path

import bpy
import numpy as np
import pytest
import small_scenes as scenes
import torch
from vibe_render.core import compat
from vibe_render.scene import bindings

from proxy_renderer.render.film import Film
from proxy_renderer.scene import FilmSettings

SIZE = 96
PIVOT = (0.0, 0.0, 0.0)
CONFIG = Path(bpy.utils.resource_path("LOCAL")) / "datafiles" / "colormanagement" / "config.ocio"


@pytest.fixture
def picture():
    """(H, W, 3), row 0 on top: grays and colors of all saturations, from 2^-9 to 2^4, and black."""
    random = np.random.default_rng(3)
    tint = random.uniform(0, 1, (SIZE, SIZE, 3)) ** random.choice([0.1, 0.5, 2.0], (SIZE, SIZE, 1))
    pixels = tint / tint.max(-1, keepdims=True) * 2.0 ** np.linspace(-9.0, 4.0, SIZE)[None, :, None]
    pixels[:8] = pixels[:8].mean(-1, keepdims=True)
    pixels[0, 0] = 0.0
    return pixels.astype(np.float32)


@pytest.fixture
def stage(scene, picture):
    """A scene whose compositor shows the picture."""
    tree = scenes.compositor(scene)
    image = bpy.data.images.new("Known", SIZE, SIZE, float_buffer=True)
    image.pixels.foreach_set(np.dstack((picture, np.ones_like(picture[..., :1])))[::-1].ravel())
    node = tree.nodes.new("CompositorNodeImage")
    node.image = image
    tree.links.new(node.outputs["Image"], compat.compositor_output(tree))
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.engine, scene.cycles.samples = "CYCLES", 1
    scene.render.dither_intensity = 0.0
    scenes.camera(scene)
    return scene


def shown(scene, folder):
    """(H, W, 3) in [0, 1]: what an artist sees, to 16 bits."""
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "TIFF", "RGB", "16"
    settings.tiff_codec = "NONE"
    scene.render.filepath = str(folder / "shown.tif")
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.array(image.pixels[:]).reshape(SIZE, SIZE, 4)[::-1, :, :3]
    bpy.data.images.remove(image)
    return torch.from_numpy(pixels.astype(np.float32))


def developed(scene, picture, **values):
    """The same by the engine."""
    view = scene.view_settings
    look = "" if view.look == "None" else view.look
    film = FilmSettings(
        ocio=str(CONFIG), display=scene.display_settings.display_device, view=view.view_transform, look=look,
        transparent=False, working_space="Linear Rec.709",
    )  # fmt: skip
    tensors = {
        f"film/{name}": torch.tensor(np.atleast_1d(value), dtype=torch.float32) for name, value in values.items()
    }
    return Film(film, (SIZE, SIZE)).develop(torch.from_numpy(picture), tensors)


VIEWS = [
    *((view, "None") for view in ("Standard", "AgX", "Filmic", "Filmic Log", "Khronos PBR Neutral", "Raw")),
    *((view, "None") for view in ("ACES 1.3", "ACES 2.0")),
    *(("AgX", f"AgX - {look}") for look in ("Punchy", "Greyscale", "Very High Contrast")),
    ("Filmic", "Very High Contrast"),
]


@pytest.mark.parametrize(("view", "look"), VIEWS)
def test_view_transform(stage, picture, tmp_path, view, look):
    try:
        stage.view_settings.view_transform, stage.view_settings.look = view, look
    except TypeError:
        pytest.skip(f"This Blender has no {view} {look}")
    error = (developed(stage, picture) - shown(stage, tmp_path)).abs() * 255
    print(f"{view} {look}: mean {error.mean():.3f}/255, max {error.max():.1f}/255")
    assert error.mean() < 0.5


@pytest.mark.parametrize(
    "values",
    [
        {"exposure": 1.5, "gamma": 0.7},
        {"exposure": -1.0, "gamma": 1.8},
        {"grade_exposure": -1.0},
        {"lift": (0.8, 1.1, 1.25), "midtone": (0.7, 1.0, 1.4), "gain": (0.6, 1.0, 1.5)},
        {"contrast": 1.7},
        {"contrast": 0.6},
        {"saturation": 0.3},
        {"saturation": 1.9},
        {"hue": 70.0},
        {"hue": -30.0},
        {"grade_gamma": 1.6},
        {"vignette": 0.8},
    ],
    ids=str,
)
def test_grade(stage, picture, tmp_path, values):
    keyed = {f"film/{name}": np.atleast_1d(value) for name, value in values.items()}
    assert bindings.write(stage, keyed, (), PIVOT) == {}
    error = (developed(stage, picture, **values) - shown(stage, tmp_path)).abs() * 255
    print(f"{values}: mean {error.mean():.3f}/255, max {error.max():.1f}/255")
    assert error.mean() < 0.5


def test_bloom(stage, tmp_path):
    picture = np.full((SIZE, SIZE, 3), 0.1, np.float32)
    picture[40:50, 30:60] = (6.0, 4.0, 1.0)
    picture[70, 70] = 40.0
    pixels = np.dstack((picture, np.ones_like(picture[..., :1])))[::-1]
    bpy.data.images["Known"].pixels.foreach_set(pixels.ravel())
    assert bindings.write(stage, {"film/glare": np.array([0.6])}, (), PIVOT) == {}
    error = (developed(stage, picture, glare=0.6) - shown(stage, tmp_path)).abs() * 255
    print(f"bloom: mean {error.mean():.2f}/255, max {error.max():.1f}/255")
    assert error.mean() < 1.0
