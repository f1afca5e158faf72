# SPDX-License-Identifier: GPL-3.0-or-later
"""The catalogs of Blender's Asset Browser: a text file at the root of an asset library. No bpy here."""

from __future__ import annotations

import uuid
from collections.abc import Iterable
from pathlib import Path

from ..core.files import whole
from ..core.schema_import import schema

CATALOG_FILE = "blender_assets.cats.txt"
_SPACE = uuid.UUID("5b1f2a86-6f0c-4f6e-9a43-2f5d8b0c7e11")
"""Our namespace: a catalog of ours has the same id in every library."""
_HEAD = """# This is an Asset Catalog Definition file for Blender.
#
# Empty lines and lines starting with `#` will be ignored.
# The first non-ignored line should be the version indicator.
# Other lines are of the format "UUID:catalog/path/for/assets:simple catalog name"

VERSION 1

"""


def catalog_identifier(path: str) -> str:
    """The id of a catalog of ours, such as "Vibe Render/Materials"."""
    return str(uuid.uuid5(_SPACE, path))


def catalog_root(folder: Path, libraries: Iterable[str]) -> Path:
    """The folder whose catalog file counts for the assets of a .blend.

    Args:
        libraries: The folders of the artist's asset libraries.
    """
    folder = folder.resolve()
    for library in filter(None, libraries):
        place = Path(library).resolve()
        if place == folder or place in folder.parents:
            return place
    return next((place for place in (folder, *folder.parents) if (place / CATALOG_FILE).is_file()), folder)


def add_catalogs(place: Path, paths: Iterable[str]) -> None:
    """Adds catalogs to those of a library, which stay as they are.

    Args:
        place: The folder of the catalog file.
        paths: The new catalogs, such as "Vibe Render/Materials".

    Raises:
        VibeError: The file cannot be read or written, or is of a newer version.
    """
    file = place / CATALOG_FILE
    try:
        text = file.read_text(encoding="utf-8") if file.exists() else _HEAD
        lines = [line.strip() for line in text.splitlines()]
        if "VERSION 1" not in lines:
            raise schema.VibeError(f"{file} is of another version.", "Choose another folder.")
        present = {line.partition(":")[0] for line in lines}
        rows = [f"{catalog_identifier(path)}:{path}:{path.replace('/', '-')}" for path in paths]
        missing = [row for row in rows if row.partition(":")[0] not in present]
        if not missing:
            return
        with whole(file) as part:
            part.write_text(text.rstrip("\n") + "\n" + "\n".join(missing) + "\n", encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise schema.VibeError(f"{file} cannot be changed: {error}.", "Choose another folder.") from error
