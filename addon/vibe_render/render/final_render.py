# SPDX-License-Identifier: GPL-3.0-or-later
"""Final renders: the scene's own render with Cycles, a mask of the subject, and a test for black images."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import bpy
import numpy as np
from bpy.types import Object, Scene

from ..core import rendered
from ..core.compat import assign, changed
from ..core.files import whole
from ..core.temporary import temporary
from ..scene.copies import copied_scene
from . import bake, light_groups
from .light_groups import LightLayer


def render_picture(
    scene: Scene, path: Path, size: int, samples: int, seed: int = 0, exact: bool = False, lights: Path | None = None
) -> list[LightLayer]:
    """Renders the current frame with Cycles on the CPU, compositor and view transform included, to a PNG.

    The file appears whole or not at all; a VibeError says why it cannot be written. `size` is the longer side in pixels,
    `samples` the maximum for a pixel. An `exact` render has no adaptive sampling and no denoising: for measurements.

    If `lights` is a path, the light layers (one per light group) are written there as a multilayer EXR: scene-linear,
    noisy, before compositor and exposure. The layers are also returned, named as their groups; else an empty list.
    """
    with copied_scene(scene, graded=True) as twin:
        set_up(twin, size, samples, seed)
        if exact:
            assign(twin.cycles, use_adaptive_sampling=False, use_denoising=False)
        mode = "RGBA" if scene.render.film_transparent else "RGB"
        if lights is None:
            bake.render_file(twin, path, bake.png(mode))
            return []
        layer = rendered.layer(twin)
        layer.cycles.denoising_store_passes = twin.cycles.use_denoising
        layers = light_groups.light_layers(scene)
        own, new = ([each for each in layers if each.own == mine] for mine in (True, False))
        with light_groups.grouped(layer, [(each.name, each.members) for each in new]) as names:
            bake.render_file(twin, lights, {**bake.LAYERS, "exr_codec": "ZIP"})
        assign(twin.render.image_settings, **bake.png(mode))
        with whole(path) as part:
            bpy.data.images["Render Result"].save_render(str(part), scene=twin)
    return own + [replace(each, name=name) for name, each in zip(names, new, strict=True)]


def render_final(scene: Scene, path: Path) -> None:
    """Renders the current frame to a PNG with the scene's own settings, but with Cycles; see `render_picture`."""
    own = {name: getattr(scene.render, name) for name in ("use_sequencer", "use_border", "use_multiview")}
    with copied_scene(scene, graded=True, engine="CYCLES", **own) as twin:
        bake.render_file(twin, path, bake.png("RGBA" if scene.render.film_transparent else "RGB"))


def render_mask(scene: Scene, path: Path, size: int, subject: Iterable[Object]) -> None:
    """Renders a gray PNG, longer side `size` pixels: the share of each pixel that the subject covers, 1 is white."""
    theirs = {o.name_full for o in subject}
    with ExitStack() as stack:
        twin = stack.enter_context(copied_scene(scene, film_transparent=True))
        set_up(twin, size, 16, 0)
        assign(twin.cycles, use_denoising=False, max_bounces=0)
        rendered.set_world(twin, None)
        for thing in scene.objects:  # objects in front of the subject hide it, fog does not
            holdout = thing.name_full not in theirs and thing.type not in ("LIGHT", "CAMERA")
            hiding = {"hide_render": True} if is_fog(thing) else {"is_holdout": holdout}
            stack.enter_context(changed(thing, **hiding))
        _save(np.repeat(bake.render_pixels(twin, bake.png("RGBA"))[..., 3:], 3, axis=2), path)


def set_up(twin: Scene, size: int, samples: int, seed: int) -> None:
    """Sets a copied scene up for Cycles on the CPU; `size` is the longer side in pixels."""
    import _cycles  # type: ignore[import-not-found]  # exists once the Cycles add-on is enabled

    render, cycles = twin.render, twin.cycles
    factor = size / max(render.resolution_x, render.resolution_y)
    width, height = (max(1, round(side * factor)) for side in (render.resolution_x, render.resolution_y))
    assign(render, engine="CYCLES", resolution_x=width, resolution_y=height, resolution_percentage=100)
    assign(cycles, device="CPU", samples=samples, time_limit=0.0, seed=seed, use_animated_seed=False)
    # Adaptive sampling leaves some noise, which the denoiser removes.
    assign(cycles, use_adaptive_sampling=True, adaptive_threshold=0.05, adaptive_min_samples=min(16, samples))
    # FAST saves a fifth of the time without a visible difference, except in fog, where albedo and normals are noisy
    prefilter = "ACCURATE" if any(map(is_fog, twin.objects)) else "FAST"
    denoises = bool(getattr(_cycles, "with_openimagedenoise", False))
    assign(cycles, use_denoising=denoises, denoising_prefilter=prefilter)
    if denoises:
        cycles.denoiser = "OPENIMAGEDENOISE"


def is_fog(thing: Object) -> bool:
    """True for a volume, and for an object that has materials, but none with a surface."""
    slots = [slot.material for slot in thing.material_slots if slot.material]
    return thing.type == "VOLUME" or (bool(slots) and not any(rendered.has_surface(m) for m in slots))


def join_pictures(pictures: Sequence[Path], path: Path) -> None:
    """Writes images of the same size next to each other, from left to right, into one PNG, atomically."""
    _save(np.concatenate([bake.read_file(picture)[..., :3] for picture in pictures], axis=1), path)


def _save(pixels: np.ndarray, path: Path) -> None:
    """Writes an opaque image, (H, W, 3) with row 0 at the bottom, as a PNG, atomically."""
    height, width, _ = pixels.shape
    with temporary(bpy.data.images.new("Vibe Picture", width, height, alpha=False, is_data=True)) as image:
        image.pixels.foreach_set(np.pad(pixels, ((0, 0), (0, 0), (0, 1)), constant_values=1.0).ravel())
        with whole(path) as part:
            image.filepath_raw, image.file_format = str(part), "PNG"
            image.save()


def is_black(picture: Path) -> bool:
    """True if every pixel of an image is black, or nearly: below 2 % of white, as stored."""
    return bool(bake.read_file(picture)[..., :3].max() < 0.02)
