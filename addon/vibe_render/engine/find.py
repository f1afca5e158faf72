# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds the Python that the engine is installed in. No bpy here."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from ..core.schema_import import schema

_ADDON = Path(__file__).resolve().parents[1]
ENVIRONMENT_VARIABLE = "VIBE_ENGINE"
BUILT_FROM = _ADDON / "engine.txt"
"""Written when the extension is built: the Python that built it, on this machine."""

CARRIED = _ADDON / "carried"
"""The engine's code in a built extension: its environment then holds only the packages that it needs."""

_CLONE = _ADDON.parents[1]
_NEEDED = ("torch", "open_clip", "trimesh", "PyOpenColorIO", "proxy_renderer")
_PROBE = f"import sys, importlib.util as u; sys.exit(not all(map(u.find_spec, {_NEEDED})))"
_HELP = (
    "Press Set Up Engine in the add-on's preferences; or run `pip install .` in a clone of Vibe Render (in a "
    f"virtual environment) and choose that environment's folder there or in {ENVIRONMENT_VARIABLE}."
)


def find_python(chosen: str = "") -> Path:
    """The Python that has the engine; a VibeError without one.

    It is searched, unless a Python or the folder of its environment is chosen here, or by VIBE_ENGINE.
    """
    chosen = os.environ.get(ENVIRONMENT_VARIABLE, "") or chosen
    if chosen:
        python = python_of(Path(chosen).expanduser())
        if python is None or not has_engine(python):
            raise schema.VibeError(f"There is no Vibe engine in {chosen}.", _HELP)
        return python
    for python in _likely():
        if has_engine(python):
            return python
    raise schema.VibeError("The Vibe engine was not found on this computer.", _HELP)


def engine_environment() -> dict[str, str]:
    """The environment variables that the engine runs with."""
    variables = {k: v for k, v in os.environ.items() if k not in ("PYTHONHOME", "PYTHONSTARTUP")}
    # An extension uses the engine that it carries, a clone's add-on its own clone's: they speak one schema.
    code = next(
        (p for p in (CARRIED, _CLONE) if (p / "proxy_renderer" / "engine" / "worker.py").is_file()), None
    )
    if code:
        paths = [str(code), *filter(None, [variables.get("PYTHONPATH")])]
        variables["PYTHONPATH"] = os.pathsep.join(paths)
    return variables


def has_engine(python: Path) -> bool:
    """True if this Python runs and has the engine's packages; it is started for that, but imports nothing."""
    try:
        done = subprocess.run(
            [python, "-c", _PROBE], env=engine_environment(), capture_output=True, timeout=20
        )
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def _likely() -> Iterator[Path]:
    """Pythons that may have the engine, the most specific first."""
    places: list[Path] = []
    if BUILT_FROM.is_file():
        places.append(Path(BUILT_FROM.read_text(encoding="utf-8").strip()))
    places += [*sorted(_CLONE.glob(".venv*"), reverse=True), Path(sys.executable)]
    if command := shutil.which("vibe"):
        places.append(Path(command).resolve().parent)  # pipx and uv link the command to its environment
    places += [Path(p) for p in map(shutil.which, ("python3", "python")) if p]
    yield from dict.fromkeys(p for p in map(python_of, places) if p)


def own_group() -> dict:
    """Arguments of `Popen` for a process that Ctrl-C in Blender's terminal does not reach."""
    if sys.platform == "win32":
        return {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.CREATE_NO_WINDOW}
    return {"start_new_session": True}


def python_of(place: Path) -> Path | None:
    """The Python at a place: itself, an environment or its commands. Resolving links would leave that."""
    if place.is_file():
        return place
    names = ("bin/python3", "bin/python", "Scripts/python.exe", "python3", "python", "python.exe")
    return next((place / n for n in names if (place / n).is_file()), None)
