# SPDX-License-Identifier: GPL-3.0-or-later
"""Final pictures: the scene's own render with Cycles, and a mask of where the subject is in it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ..core import compat
from ..core.files import whole
from ..core.overrides import changed
from ..scene.geometry.meshes import has_surface

_NOISE = 0.05
"""Where a pixel's noise is below this, sampling it stops: the denoiser does the rest."""

_MASK_SAMPLES = 16


def render(
    scene: bpy.types.Scene, path: Path, size: int, samples: int, seed: int = 0, exact: bool = False
) -> None:
    """Renders the current frame with Cycles on the CPU, compositor and view transform included, to a PNG.

    The file appears whole or not at all, and every setting is put back.

    Args:
        size: Longer side of the picture, pixels; the scene's aspect is kept.
        samples: Most samples in a pixel.
        seed: Of the sampling pattern.
        exact: Take every sample of every pixel, and leave the noise as it is: for measurements.

    Raises:
        VibeError: The file cannot be written.
    """
    plain = {"use_adaptive_sampling": False, "use_denoising": False} if exact else {}
    with _cycles(scene, size, samples, seed), changed(scene.cycles, **plain), _quiet_outputs(scene):
        mode = "RGBA" if scene.render.film_transparent else "RGB"
        _write(scene, path, mode)


def render_final(scene: bpy.types.Scene, path: Path) -> None:
    """Renders the current frame with Cycles as the scene says, at its own size and samples, to a PNG; see `render`."""
    with (
        changed(scene.render, engine="CYCLES", use_overwrite=True, use_file_extension=True),
        _quiet_outputs(scene),
    ):
        _write(scene, path, "RGBA" if scene.render.film_transparent else "RGB")


def render_layers(
    scene: bpy.types.Scene, layer: bpy.types.ViewLayer, path: Path, size: int, samples: int, seed: int
) -> None:
    """Renders one view layer as `render` does, with all its passes to a compressed file as of `write_layers`."""
    with _cycles(scene, size, samples, seed):
        write_layers(scene, layer, path, exr_codec="ZIP")


def write_layers(scene: bpy.types.Scene, layer: bpy.types.ViewLayer, path: Path, **options: Any) -> None:
    """Renders one view layer, as the scene is set up, with all its passes to a multilayer EXR of 32-bit floats.

    The file appears whole or not at all. Raises as `render` does.

    Args:
        options: More settings of the file.
    """
    kind = {"media_type": "MULTI_LAYER_IMAGE", "file_format": "OPEN_EXR_MULTILAYER", "color_depth": "32"}
    _write_as(scene, path, kind | options, layer=layer.name)


def render_mask(scene: bpy.types.Scene, path: Path, size: int, subject: Iterable[bpy.types.Object]) -> None:
    """Renders where the subject is in the picture: a gray PNG, white where it covers a pixel all.

    What stands before the subject hides it; fog and the grade do not. Raises as `render` does.

    Args:
        subject: The objects, including instancers.
    """
    theirs = {o.name_full for o in subject}
    with ExitStack() as stack:
        stack.enter_context(_cycles(scene, size, _MASK_SAMPLES, 0))
        stack.enter_context(changed(scene.cycles, use_denoising=False, max_bounces=0))
        stack.enter_context(changed(scene.render, film_transparent=True, use_compositing=False))
        stack.enter_context(changed(scene, world=None))
        for thing in scene.objects:
            fog = thing.type == "VOLUME" or _is_fog(thing)
            holdout = thing.name_full not in theirs and thing.type not in ("LIGHT", "CAMERA")
            stack.enter_context(changed(thing, **({"hide_render": True} if fog else {"is_holdout": holdout})))
        with tempfile.TemporaryDirectory(prefix="vibe-") as folder:
            rendered = Path(folder) / path.name
            _write(scene, rendered, "RGBA")
            _keep_alpha(rendered, path)


def render_clear(scene: bpy.types.Scene, path: Path, size: int, samples: int, seed: int = 0) -> None:
    """Renders the scene as `render` does, but without the fog in it."""
    with ExitStack() as stack:
        for thing in scene.objects:
            if thing.type == "VOLUME" or _is_fog(thing):
                stack.enter_context(changed(thing, hide_render=True))
        tree = compat.node_tree(scene.world) if scene.world else None
        for node in tree.nodes if tree else ():
            if node.bl_idname.startswith("ShaderNodeVolume"):
                stack.enter_context(changed(node, mute=True))
        render(scene, path, size, samples, seed)


@contextmanager
def _cycles(scene: bpy.types.Scene, size: int, samples: int, seed: int) -> Iterator[None]:
    """The scene set up for one picture of this size."""
    render = scene.render
    width, height = render.resolution_x, render.resolution_y
    factor = size / max(width, height)
    with (
        changed(
            render,
            engine="CYCLES",
            resolution_x=max(1, round(width * factor)),
            resolution_y=max(1, round(height * factor)),
            resolution_percentage=100,
            use_border=False,
            use_sequencer=False,
            use_multiview=False,
            use_overwrite=True,
            use_file_extension=True,
        ),
        changed(
            scene.cycles,
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
        ),
        changed(scene.cycles, **({"denoiser": "OPENIMAGEDENOISE"} if _can_denoise() else {})),
    ):
        yield


def _can_denoise() -> bool:
    import _cycles  # type: ignore[import-not-found]  # there as soon as the Cycles add-on is

    return bool(getattr(_cycles, "with_openimagedenoise", False))


@contextmanager
def _quiet_outputs(scene: bpy.types.Scene) -> Iterator[None]:
    """Mutes the File Output nodes of the artist's compositor inside the block."""
    tree = compat.compositor(scene)
    nodes = [n for n in (tree.nodes if tree else ()) if n.bl_idname == "CompositorNodeOutputFile"]
    with ExitStack() as stack:
        for node in nodes:
            stack.enter_context(changed(node, mute=True))
        yield


def _write(scene: bpy.types.Scene, path: Path, mode: str) -> None:
    """Renders to a PNG, atomically."""
    kind = {"media_type": "IMAGE", "file_format": "PNG"}
    _write_as(scene, path, {**kind, "color_mode": mode, "color_depth": "8", "compression": 15})


def _write_as(scene: bpy.types.Scene, path: Path, kind: dict[str, Any], **options: str) -> None:
    """Renders to a file of a kind, atomically."""
    with (
        whole(path) as part,
        _kind(scene.render.image_settings, kind),
        changed(scene.render, filepath=str(part)),
    ):
        bpy.ops.render.render(scene=scene.name, write_still=True, **options)


@contextmanager
def _kind(picture: bpy.types.ImageFormatSettings, kind: dict[str, Any]) -> Iterator[None]:
    """Temporarily sets another file format; later settings in `kind` are valid only after the earlier ones."""
    names = [name for name in kind if name in picture.bl_rna.properties]
    old = [getattr(picture, name) for name in names]
    try:
        for name in names:
            setattr(picture, name, kind[name])
        yield
    finally:
        for name, value in zip(names, old, strict=True):
            setattr(picture, name, value)


def _is_fog(thing: bpy.types.Object) -> bool:
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
