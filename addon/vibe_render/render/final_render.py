# SPDX-License-Identifier: GPL-3.0-or-later
"""Final pictures: the scene's own render with Cycles, and a mask of where the subject is in it.

A copy of the scene is rendered: the artist's own settings of the render and its file are not touched.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..core.compat import assign, changed
from ..core.files import whole
from ..scene.copies import copied_scene
from ..scene.geometry.meshes import has_surface

_NOISE = 0.05
"""Where a pixel's noise is below this, sampling it stops: the denoiser does the rest."""

_MASK_SAMPLES = 16


def render(
    scene: bpy.types.Scene, path: Path, size: int, samples: int, seed: int = 0, exact: bool = False
) -> None:
    """Renders the current frame with Cycles on the CPU, compositor and view transform included, to a PNG.

    The file appears whole or not at all.

    Args:
        size: Longer side of the picture, pixels; the scene's aspect is kept.
        samples: Most samples in a pixel.
        exact: Take every sample of every pixel, and leave the noise as it is: for measurements.

    Raises:
        VibeError: The file cannot be written.
    """
    with copied_scene(scene, graded=True) as twin:
        _set_up(twin, size, samples, seed)
        if exact:
            assign(twin.cycles, use_adaptive_sampling=False, use_denoising=False)
        _write(twin, path, "RGBA" if scene.render.film_transparent else "RGB")


def render_final(scene: bpy.types.Scene, path: Path) -> None:
    """Renders the current frame with Cycles as the scene says, at its own size and samples, to a PNG; see `render`."""
    own = {name: getattr(scene.render, name) for name in ("use_sequencer", "use_border", "use_multiview")}
    with copied_scene(scene, graded=True, engine="CYCLES", **own) as twin:
        _write(twin, path, "RGBA" if scene.render.film_transparent else "RGB")


def render_layers(
    twin: bpy.types.Scene, layer: bpy.types.ViewLayer, path: Path, size: int, samples: int, seed: int
) -> None:
    """Renders one view layer as `render` does, with all its passes to a compressed file as of `write_layers`."""
    _set_up(twin, size, samples, seed)
    write_layers(twin, layer, path, exr_codec="ZIP")


def write_layers(twin: bpy.types.Scene, layer: bpy.types.ViewLayer, path: Path, **options: Any) -> None:
    """Renders one view layer, as the scene is set up, with all its passes to a multilayer EXR of 32-bit floats.

    The file appears whole or not at all. Raises as `render` does.

    Args:
        twin: A scene of ours, whose settings of the file may change.
    """
    kind = {"media_type": "MULTI_LAYER_IMAGE", "file_format": "OPEN_EXR_MULTILAYER", "color_depth": "32"}
    _write_as(twin, path, kind | options, layer=layer.name)


def render_mask(scene: bpy.types.Scene, path: Path, size: int, subject: Iterable[bpy.types.Object]) -> None:
    """Renders where the subject is in the picture: a gray PNG, white where it covers a pixel all.

    What stands before the subject hides it; fog and the grade do not. Raises as `render` does.

    Args:
        size: Longer side of the picture, pixels.
    """
    theirs = {o.name_full for o in subject}
    with ExitStack() as stack:
        twin = stack.enter_context(copied_scene(scene, film_transparent=True))
        _set_up(twin, size, _MASK_SAMPLES, 0)
        assign(twin.cycles, use_denoising=False, max_bounces=0)
        twin.world = None
        for thing in scene.objects:
            fog = thing.type == "VOLUME" or is_fog(thing)
            holdout = thing.name_full not in theirs and thing.type not in ("LIGHT", "CAMERA")
            stack.enter_context(changed(thing, **({"hide_render": True} if fog else {"is_holdout": holdout})))
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            rendered = Path(folder) / path.name
            _write(twin, rendered, "RGBA")
            _keep_alpha(rendered, path)


def _set_up(twin: bpy.types.Scene, size: int, samples: int, seed: int) -> None:
    """Sets a scene of ours up for one picture of this size."""
    render = twin.render
    width, height = render.resolution_x, render.resolution_y
    factor = size / max(width, height)
    assign(
        render,
        engine="CYCLES",
        resolution_x=max(1, round(width * factor)),
        resolution_y=max(1, round(height * factor)),
        resolution_percentage=100,
    )
    assign(
        twin.cycles,
        device="CPU",
        samples=samples,
        seed=seed,
        use_animated_seed=False,
        use_adaptive_sampling=True,
        adaptive_threshold=_NOISE,
        adaptive_min_samples=min(16, samples),
        use_denoising=_can_denoise(),
        denoising_prefilter="FAST",  # a fifth of the whole time less, for no difference to be seen
        time_limit=0.0,
    )
    if _can_denoise():
        twin.cycles.denoiser = "OPENIMAGEDENOISE"


def _can_denoise() -> bool:
    import _cycles  # type: ignore[import-not-found]  # there as soon as the Cycles add-on is

    return bool(getattr(_cycles, "with_openimagedenoise", False))


def _write(twin: bpy.types.Scene, path: Path, mode: str) -> None:
    """Renders to a PNG, atomically."""
    kind = {"media_type": "IMAGE", "file_format": "PNG"}
    _write_as(twin, path, {**kind, "color_mode": mode, "color_depth": "8", "compression": 15})


def _write_as(twin: bpy.types.Scene, path: Path, kind: dict[str, Any], **options: str) -> None:
    """Renders to a file of a kind, atomically; later settings of a kind are valid only after the earlier ones."""
    assign(twin.render.image_settings, **kind)
    assign(twin.render, use_overwrite=True, use_file_extension=True)
    with whole(path) as part:
        twin.render.filepath = str(part)
        bpy.ops.render.render(scene=twin.name, write_still=True, **options)


def is_fog(thing: bpy.types.Object) -> bool:
    """Whether all materials of a thing are fog."""
    slots = [slot.material for slot in thing.material_slots if slot.material]
    return bool(slots) and not any(has_surface(m) for m in slots)


def _keep_alpha(rendered: Path, path: Path) -> None:
    """Writes the alpha of one PNG as the gray of another, atomically."""
    source = bpy.data.images.load(str(rendered))
    source.alpha_mode = "CHANNEL_PACKED"
    source.colorspace_settings.name = "Non-Color"
    width, height = source.size
    flat = np.empty(width * height * 4, np.float32)
    source.pixels.foreach_get(flat)
    bpy.data.images.remove(source)
    mask = bpy.data.images.new("Vibe Mask", width, height, alpha=False, is_data=True)
    try:
        mask.pixels.foreach_set(np.repeat(flat[3::4, None], 4, axis=1).ravel())
        with whole(path) as part:
            mask.filepath_raw, mask.file_format = str(part), "PNG"
            mask.save()
    finally:
        bpy.data.images.remove(mask)
