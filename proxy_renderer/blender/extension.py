# SPDX-License-Identifier: Apache-2.0
"""Builds the extension's zip, installs it, and indexes it for Blender's preferences. Blender's own tools do all three.

The zip holds the add-on, the schema that it reads, and the engine's code, which Blender never imports: the
engine is a process of its own, for which the add-on's *Set Up Engine* makes an environment.
"""

import importlib.util
import shutil
import subprocess
import sys
import tempfile
import tomllib
from importlib import metadata
from pathlib import Path

from ..schema import VibeError, atomic
from ..schema.options import checks
from .launch import blender_side

_LEFTOVERS = ("__pycache__", "*.pyc", "*.md")
_OF_THE_COMMAND = ("cli", "batch", "blender", "preset.py")
"""Folders and modules of the engine's package that only the command `vibe` runs: the zip leaves them out."""


def build(out: Path) -> Path:
    """Builds and validates OUT/vibe_render-VERSION.zip; returns its path. Raises VibeError if that fails."""
    with tempfile.TemporaryDirectory() as scratch:
        package = Path(scratch) / "vibe_render"
        _assemble(package)
        _ask("validate", str(package))
        _ask("build", "--source-dir", str(package), "--output-dir", scratch)
        _ask("validate", str(archive := next(Path(scratch).glob("*.zip"))))
        target = checks.folder(out) / archive.name
        with atomic.replacing(target) as part:  # so that OUT never holds a broken zip
            shutil.copyfile(archive, part)
        return target


def repository(out: Path) -> Path:
    """Builds the extension into a folder, in place of its older versions, and returns the index that Blender subscribes to."""
    archive = build(out)
    for older in set(out.glob("vibe_render-*.zip")) - {archive}:  # of two, Blender installs the first
        older.unlink()
    _ask("server-generate", "--repo-dir", str(out))
    return out / "index.json"


def install(blender: str = "") -> str:
    """Builds, installs and enables the extension; returns a message. Raises VibeError if that fails.

    `blender` is Blender's program or its folder; "" for the program on the PATH.
    """
    if blender:
        place = Path(blender).expanduser()
        candidates = (place / name for name in ("", "blender", "blender.exe", "Contents/MacOS/Blender"))
        program = next((str(path.absolute()) for path in candidates if path.is_file()), None)
        if program is None:
            raise VibeError(f"There is no Blender in {blender}.", "Name the program: --blender /path/to/blender.")
    elif (program := shutil.which("blender")) is None:
        raise VibeError("There is no `blender` on the PATH.", "Name it: --blender /path/to/blender.")
    with tempfile.TemporaryDirectory() as scratch:
        archive = build(Path(scratch))
        how = [program, "--command", "extension", "install-file", "-r", "user_default", "-e", str(archive)]
        try:
            done = subprocess.run(how, capture_output=True, text=True, errors="replace")
        except OSError as error:
            raise VibeError(f"{program} does not start: {error.strerror}.", "Choose another --blender.") from error
    output = (done.stdout + done.stderr).strip()  # Blender may report errors and still exit with 0
    if done.returncode or "Error" in output:
        line = next((line for line in output.splitlines() if "rror" in line), output.rpartition("\n")[2])
        raise VibeError(f"Blender refused to install the extension: {line}", "Blender 4.2 or later is needed.")
    return f"{archive.name} is installed and enabled in {program}."


def _assemble(package: Path) -> None:
    """Copies add-on, schema and engine's code to the folder `package`, and notes the path of this Python there."""
    here = Path(__file__).parents[1]
    leftovers = shutil.ignore_patterns(*_LEFTOVERS)
    shutil.copytree(blender_side().parent, package, ignore=leftovers)
    shutil.copytree(here / "schema", package / "schema", ignore=leftovers)
    engine = shutil.ignore_patterns(*_LEFTOVERS, *_OF_THE_COMMAND)
    shutil.copytree(here, package / "carried" / here.name, ignore=engine)
    project = here.resolve().parent / "pyproject.toml"
    if project.is_file():
        needed = tomllib.loads(project.read_text(encoding="utf-8"))["project"]["dependencies"]
    else:
        needed = [line for line in metadata.requires("vibe-render") or [] if "extra ==" not in line]
    requirements = "\n".join(line for line in needed if not line.startswith("bpy"))
    (package / "carried" / "requirements.txt").write_text(requirements, encoding="utf-8")
    (package / "engine.txt").write_text(sys.executable, encoding="utf-8")


def _ask(*arguments: str) -> None:
    """Runs Blender's extension tool, part of the bpy package, with these arguments. Raises VibeError if it fails."""
    spec = importlib.util.find_spec("bpy")
    places = (spec.submodule_search_locations or []) if spec else []
    tools = [tool for place in places for tool in Path(place).glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")]
    if not tools:
        remedy = "Install it with `pip install bpy` on Python 3.11 or 3.13."
        raise VibeError("Blender's packing tool was not found.", remedy)
    done = subprocess.run([sys.executable, str(tools[0]), *arguments], capture_output=True, text=True)
    if done.returncode:
        complaint = (done.stderr or done.stdout).strip().rpartition("\n")[2]
        raise VibeError(f"Blender's tool refused to {arguments[0]} the extension: {complaint}", "Report this as a bug.")
