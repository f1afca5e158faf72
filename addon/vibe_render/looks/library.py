# SPDX-License-Identifier: GPL-3.0-or-later
"""The preset library: the presets that come with Vibe Render, and the artist's own in the user's Blender folder.

A preset is NAME.json with an image NAME.jpg next to it. Functions raise VibeError if a file cannot be read or written,
if a preset is broken, or if a shipped preset is to be changed.
"""

from __future__ import annotations

import contextlib
import re
import unicodedata
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import bpy

from ..core.files import whole
from ..core.schema_import import preset, schema
from . import thumbnail, transfer

SHIPPED = Path(__file__).parent / "shipped"  # the folder of the presets that come with Vibe Render
_LARGEST_PICTURE = 4_000_000  # bytes; shipped images have about 5000


@dataclass(frozen=True)
class Look:
    """A preset in the library. If its file cannot be read, `preset` is None, and `problem` is the reason."""

    path: Path  # of the .json file
    name: str  # in lists: its title, or else the file's name
    preset: preset.Preset | None = None
    prompt: str = ""  # the words that the preset was made from; "" if there are none
    problem: str = ""

    @property
    def shipped(self) -> bool:
        """True if the preset comes with Vibe Render; then it can neither be renamed nor deleted."""
        return self.path.parent == SHIPPED

    @property
    def picture(self) -> Path:
        """The path of the preset's image, which may not exist."""
        return self.path.with_suffix(thumbnail.SUFFIX)


def preset_folder() -> Path:
    """The folder of the artist's own presets, which may not exist."""
    # It is among Blender's presets, because uninstalling deletes the extension's own folder.
    return Path(bpy.utils.user_resource("SCRIPTS", path="presets/vibe_render"))


def all_looks(words: str = "") -> list[Look]:
    """Presets whose name or prompt contains every word of `words`: the artist's own by name, then the shipped ones."""
    looks: list[Look] = []
    for place in (preset_folder(), SHIPPED):
        theirs = [_read(path, *_stamp(path)) for path in place.glob("[!.]*.json")]
        looks += sorted(theirs, key=lambda look: (look.name.casefold(), look.path.name))
    parts = words.casefold().split()
    return [look for look in looks if all(part in f"{look.name} {look.prompt}".casefold() for part in parts)]


def preset_named(preset_: str) -> preset.Preset:
    """Reads the preset that the command line names: `preset_` is the path of a file, or a name in the library."""
    path = Path(preset_).expanduser()
    is_path = path.suffix == ".json" or path.is_file()
    return transfer.load_preset(path if is_path else find_preset(preset_).path)


def find_preset(name: str) -> Look:
    """The preset called `name`, or the only one whose name begins so, ignoring case; raises VibeError without one."""
    library, folded = all_looks(), name.casefold().strip()
    exact = [look for look in library if look.name.casefold() == folded]
    chosen = exact or [look for look in library if look.name.casefold().startswith(folded)]
    if len({look.name for look in chosen}) == 1:
        return chosen[0]
    listed = ", ".join(look.name for look in library)
    raise schema.VibeError(f"There is no preset {name!r}.", f"Name a file, or one of: {listed}.")


def preset_at(path: str) -> Look:
    """The preset of the library whose .json file is at `path`; raises VibeError if there is none."""
    for look in all_looks():
        if str(look.path) == path:
            return look
    raise schema.VibeError("That preset is gone.", "Choose another.")


def path_for(place: Path, name: str) -> Path:
    """The path PLACE/NAME.json for a preset's name: in lower case, with "-" for all but letters, digits and "_"."""
    plain = unicodedata.normalize("NFKD", name).casefold()
    words = re.sub(r"[^\w]+", "-", plain).strip("-")[:50]
    return place / f"{words or 'look'}.json"


def rename_preset(look: Look, name: str) -> Look:
    """Renames one of the artist's presets, with a number if the name is taken; returns the renamed preset."""
    if not (name := preset.title(name)):
        raise schema.VibeError("A preset needs a name.", "Type one.")
    _check_own(look)
    if look.preset is None:
        raise schema.VibeError(look.problem, "Delete it, or correct the file.")
    renamed = save_preset(replace(look.preset, name=name), look.picture, look.path)
    if renamed.path != look.path:
        delete_preset(look)
    return renamed


def delete_preset(look: Look) -> None:
    """Deletes one of the artist's presets and its image."""
    _check_own(look)
    try:
        look.path.unlink(missing_ok=True)
        look.picture.unlink(missing_ok=True)
    except OSError as error:
        raise schema.VibeError(f"{look.path} cannot be deleted: {error.strerror}.", "Check its permissions.") from error


def import_preset(path: Path) -> Look:
    """Copies a preset file, and the image next to it, to the artist's own presets; returns the copy."""
    look = transfer.load_preset(path)
    return save_preset(replace(look, name=look.name or preset.title(path.stem)), path.with_suffix(thumbnail.SUFFIX))


def export_preset(look: Look, path: Path) -> None:
    """Writes a preset to a .json file, with its image next to it."""
    path = path.with_suffix(".json")
    if look.preset is None:
        raise schema.VibeError(look.problem, "Delete it, or correct the file.")
    _put(path, look.preset, look.picture)


def _check_own(look: Look) -> None:
    if look.shipped:
        raise schema.VibeError(f"{look.name} comes with Vibe Render.", "Save a look of your own.")


def _stamp(path: Path) -> tuple[int, int]:
    """Modification time (ns) and size (bytes) of a file, which change when the file does; (0, 0) if it is gone."""
    try:
        status = path.stat()
        return status.st_mtime_ns, status.st_size
    except OSError:
        return 0, 0


@lru_cache(maxsize=1000)  # panels ask many times a second
def _read(path: Path, _time: int, _size: int) -> Look:
    try:
        found = transfer.load_preset(path)
        return Look(path, found.name or path.stem, found, found.prompt)
    except schema.VibeError as error:
        return Look(path, path.stem, problem=str(error))


def save_preset(look: preset.Preset, picture: Path | None = None, instead: Path | None = None) -> Look:
    """Adds a preset, and the JPEG `picture` if there is one, to the artist's own presets; returns it as it is stored.

    The preset gets a number if another one has its name. The file `instead`, if given, may be overwritten.
    """
    place = preset_folder()
    with contextlib.suppress(OSError):  # writing a file there reports the reason
        place.mkdir(parents=True, exist_ok=True)
    path, number, name = path_for(place, look.name), 1, look.name
    while (SHIPPED / path.name).exists() or not (path == instead or _claimed(path)):
        number += 1
        look = replace(look, name=f"{name} {number}")
        path = path_for(place, look.name)
    try:
        _put(path, look, picture)
    except BaseException:
        if path != instead:
            with contextlib.suppress(OSError):
                path.unlink(missing_ok=True)
        raise
    return _read(path, *_stamp(path))


def _claimed(path: Path) -> bool:
    """False if the file exists; else True, and the file is created, so that another Blender cannot take the name."""
    try:
        path.open("x").close()
    except OSError as error:  # any other error is reported when the file is written
        return not isinstance(error, FileExistsError)
    return True


def _put(path: Path, look: preset.Preset, picture: Path | None) -> None:
    """Writes a preset and, next to it, its JPEG, each file whole or not at all: another Blender may read the folder."""
    copy = path.with_suffix(thumbnail.SUFFIX)
    with whole(path, "Check the folder.") as part:
        part.write_text(look.dumps() + "\n", encoding="utf-8")
        if picture and picture != copy and picture.is_file() and picture.stat().st_size <= _LARGEST_PICTURE:
            data = picture.read_bytes()
            if data.startswith(b"\xff\xd8\xff"):  # a JPEG; others are left out
                with whole(copy) as copied:
                    copied.write_bytes(data)
