# SPDX-License-Identifier: Apache-2.0
"""Checks bare meshes before Blender is started, and unpacks Draco.

Blender's side checks again what it imports: it also runs without this package.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..schema import VibeError

_LONGEST_TEXT = 16_000_000  # bytes; reading more of a text format would take longer than Blender's start


@contextmanager
def prepared(scene: Path) -> Iterator[Path]:
    """The file that Blender is to open for a scene: itself, or an unpacked copy that lives as long as the block.

    Args:
        scene: A .blend, which is left to Blender, or a mesh.

    Raises:
        VibeError: The mesh cannot be read, needs what Blender cannot do, or has no faces or no size.
    """
    if scene.suffix.lower() == ".blend":
        yield scene
        return
    from . import draco, gltf

    if scene.suffix.lower() in (".glb", ".gltf"):
        gltf.check(scene)
    with tempfile.TemporaryDirectory(prefix="vibe-mesh-") as folder:
        path = draco.unpacked(scene, Path(folder)) if draco.is_packed(scene) else scene
        check(path)
        yield path


def check(path: Path) -> None:
    """Refuses a mesh that cannot be rendered; long texts go unchecked.

    Args:
        path: A mesh of one of the formats in `options.check.SCENES`.

    Raises:
        VibeError: It is broken, or has no faces, no size, or coordinates that are not finite.
    """
    if _is_text(path) and path.stat().st_size > _LONGEST_TEXT:
        return
    import numpy as np
    import trimesh

    try:
        # Whatever a broken file holds: numpy warns of it before trimesh or we refuse it.
        with np.errstate(all="ignore"):
            scene = trimesh.load_scene(path, process=False, skip_materials=True)
    except (ImportError, NotImplementedError):
        return  # a variant of the format that trimesh does not know; Blender may
    except Exception as error:
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise VibeError(f"{path.name} cannot be read: {reason[:120]}.", "Export it again.") from error
    meshes = [m for m in scene.geometry.values() if isinstance(m, trimesh.Trimesh) and len(m.faces)]
    if not meshes:
        raise VibeError(f"There is no mesh with faces in {path.name}.", "Check that it is a model.")
    if not all(np.isfinite(m.vertices).all() for m in meshes):
        raise VibeError(f"{path.name} has coordinates that are not finite numbers.", "Export it again.")
    if not np.ptp(np.stack([b for m in meshes for b in m.bounds]), axis=0).any():
        raise VibeError(f"The mesh in {path.name} has no size.", "Check that it is a model.")


def _is_text(path: Path) -> bool:
    with path.open("rb") as file:
        return b"\0" not in file.read(1024)
