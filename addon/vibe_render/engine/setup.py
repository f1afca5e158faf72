# SPDX-License-Identifier: GPL-3.0-or-later
"""The engine's Python environment: finds it, or sets it up with a build of torch for this computer. No bpy here."""

from __future__ import annotations

import atexit
import collections
import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import IO, cast
from urllib.parse import urlsplit

from ..core import background
from ..core.schema_import import schema

_ADDON = Path(__file__).resolve().parents[1]
ENVIRONMENT_VARIABLE = "VIBE_ENGINE"
BUILT_FROM = _ADDON / "engine.txt"  # has the path of the Python that built the extension, for the computer of the build
CARRIED = _ADDON / "carried"  # the engine's code in a built extension; the environment has only the packages it needs
_CLONE = _ADDON.parents[1]
_NEEDED = ("torch", "open_clip", "trimesh", "PyOpenColorIO", "proxy_renderer")
_PROBE = f"import sys, importlib.util as u; sys.exit(not all(map(u.find_spec, {_NEEDED})))"
_HELP = (
    "Press Set Up Engine in the add-on's preferences; or run `pip install .` in a clone of Vibe Render (in a "
    f"virtual environment) and choose that environment's folder there or in {ENVIRONMENT_VARIABLE}."
)

_INDEX = "the Python Package Index (pypi.org, or the one that your pip uses)"
_VERSIONS = ((3, 11), (3, 12), (3, 13))  # of Python, for which every package has wheels
_UNREACHABLE = (
    r"NewConnectionError|Temporary failure|Network is unreachable|ConnectTimeout|ProxyError|SSLError|ReadTimeoutError"
)
_AGAIN = (
    "Press Set Up Engine again, or install it by hand (docs/install.md, On the command line) and choose its Folder."
)


def find_python(chosen: str = "") -> Path:
    """The engine's Python: in $VIBE_ENGINE, else `chosen`, else the usual places; raises VibeError if there is none."""
    chosen = os.environ.get(ENVIRONMENT_VARIABLE, "") or chosen
    if chosen:
        python = python_of(Path(chosen).expanduser())
        if python is None or not has_engine(python):
            raise schema.VibeError(f"There is no Vibe engine in {chosen}.", _HELP)
        return python
    # Pythons that may have the engine, the most specific first.
    places: list[Path] = []
    if BUILT_FROM.is_file():
        places.append(Path(BUILT_FROM.read_text(encoding="utf-8").strip()))
    places += [*sorted(_CLONE.glob(".venv*"), reverse=True), Path(sys.executable)]
    if command := shutil.which("vibe"):
        places.append(Path(command).resolve().parent)  # pipx and uv link the command to its environment
    places += [Path(p) for p in map(shutil.which, ("python3", "python")) if p]
    for python in dict.fromkeys(map(python_of, places)):
        if python and has_engine(python):
            return python
    raise schema.VibeError("The Vibe engine was not found on this computer.", _HELP)


def engine_environment() -> dict[str, str]:
    """The environment variables that the engine runs with."""
    variables = {k: v for k, v in os.environ.items() if k not in ("PYTHONHOME", "PYTHONSTARTUP")}
    # The engine's code that the extension carries, or the clone's: so add-on and engine have the same schema.
    code = next((p for p in (CARRIED, _CLONE) if (p / "proxy_renderer" / "engine" / "worker.py").is_file()), None)
    if code:
        paths = [str(code), *filter(None, [variables.get("PYTHONPATH")])]
        variables["PYTHONPATH"] = os.pathsep.join(paths)
    return variables


def has_engine(python: Path) -> bool:
    """True if this Python runs and finds the engine's packages; starts it, but imports none of them."""
    try:
        done = subprocess.run([python, "-c", _PROBE], env=engine_environment(), capture_output=True, timeout=20)
    except (OSError, subprocess.TimeoutExpired):
        return False
    return done.returncode == 0


def own_group() -> dict:
    """Arguments of `Popen` for a process that Ctrl-C in Blender's terminal does not reach."""
    if sys.platform == "win32":
        return {"creationflags": subprocess.CREATE_NEW_PROCESS_GROUP | subprocess.CREATE_NO_WINDOW}
    return {"start_new_session": True}


def python_of(place: Path) -> Path | None:
    """The Python at `place`: that file, or the one in this environment or bin folder; None if there is none."""
    # Links are not resolved, because they lead out of the environment.
    if place.is_file():
        return place
    names = ("bin/python3", "bin/python", "Scripts/python.exe", "python3", "python", "python.exe")
    return next((place / n for n in names if (place / n).is_file()), None)


@dataclass(frozen=True)
class TorchBuild:
    """One build of torch, and the size of the engine's whole environment with it."""

    name: str  # for buttons
    index: str  # address of the package index that has it; "" for pip's default index
    download: float  # of all packages, GB
    disk: float  # disk space that they take, GB


CPU = TorchBuild("Processor", "https://download.pytorch.org/whl/cpu", 0.3, 1.1)
CUDA = TorchBuild("NVIDIA Card", "", 2.5, 5.8)
USUAL = TorchBuild("Usual", "", 0.3, 1.1)  # for Windows and macOS, for which PyPI has no CUDA libraries


def choices() -> dict[str, TorchBuild]:
    """Key -> build of torch, for this operating system: "CPU" and "CUDA" on Linux, elsewhere "USUAL"."""
    return {"CPU": CPU, "CUDA": CUDA} if sys.platform == "linux" else {"USUAL": USUAL}


def suggested() -> str:
    """The key of the build, among `choices`, that suits this computer."""
    return list(choices())[-1 if has_nvidia_card() else 0]


def has_nvidia_card(root: Path = Path("/")) -> bool:
    """True on Linux with a card that NVIDIA's own driver runs: other drivers lack CUDA. `root`: the root folder."""
    cards = (root / "proc/driver/nvidia/gpus").glob("*")
    return any(cards) or (root / "usr/lib/wsl/lib/libcuda.so.1").is_file()  # in WSL


def download_text(build: TorchBuild, folder: Path) -> list[str]:
    """Lines for the artist on a build's download: its source, its size, its folder, and its fit to this computer."""
    source = f"torch from {urlsplit(build.index).netloc}, the rest from" if build.index else "from"
    lines = [
        f"Python packages, {source} {_INDEX}: about {build.download} GB to download, once.",
        f"They take {build.disk} GB in {folder}. Nothing else on this computer changes.",
    ]
    advice = {  # (whether a card was found, the build) -> a sentence
        (True, CUDA): "This computer has an NVIDIA card that it can use.",
        (True, CPU): "This computer has an NVIDIA card; this engine would not use it.",
        (False, CPU): "No NVIDIA card was found, and none is needed.",
        (False, CUDA): "No NVIDIA card was found: these are libraries that only such a card can use.",
    }
    return [*lines, advice[has_nvidia_card(), build]] if len(choices()) > 1 else lines


def requirements() -> list[str]:
    """The engine's requirements, as arguments of pip; raises VibeError in a clone, which does not carry their file."""
    try:
        lines = (CARRIED / "requirements.txt").read_text(encoding="utf-8").splitlines()
    except OSError as error:
        remedy = "Run `pip install .` in the clone that it is part of, or install the built extension."
        raise schema.VibeError("This copy of the add-on does not carry the engine.", remedy) from error
    return [line for line in lines if line]


class EngineSetup:
    """Makes the engine's Python environment in `folder`, in a thread; `packages` are arguments of pip.

    A failure or `cancel` leaves nothing behind, and an older environment in `folder` unchanged.
    """

    def __init__(self, folder: Path, packages: list[str], build: TorchBuild) -> None:
        self.folder, self._packages, self._build = folder, packages, build
        self._part = folder.with_name(f"{folder.name}.part")  # a folder in which `find_python` does not look
        self.text = "Starting"  # the present step, for the panel
        self.fraction: float | None = None  # of the present download, from 0 to 1; None while there is none
        self._process: subprocess.Popen[str] | None = None
        self._canceled = False
        atexit.register(self.cancel)
        # `work.result()` raises VibeError if the environment could not be made, or if `cancel` was called.
        self.work: Future[None] = background.begin(self._make)

    def cancel(self) -> None:
        """Ends the setup; what it has installed is deleted soon after."""
        self._canceled = True
        if self._process and self._process.poll() is None:
            with contextlib.suppress(OSError):  # the process, and those that it started
                if sys.platform == "win32":
                    kill = ["taskkill", "/F", "/T", "/PID", str(self._process.pid)]
                    subprocess.run(kill, capture_output=True)
                else:
                    os.killpg(self._process.pid, signal.SIGKILL)

    def _make(self) -> None:
        try:
            shutil.rmtree(self._part, ignore_errors=True)
            # Refuse before anything is downloaded if the disk is too full.
            place = next(parent for parent in self.folder.absolute().parents if parent.is_dir())
            free, needed = shutil.disk_usage(place).free / 1e9, self._build.disk
            if free < needed:
                room = f"{free:.1f} GB are free, the engine takes {needed:.1f} GB"
                message = f"There is not enough room on the disk: {room}."
                raise schema.VibeError(message, f"Make room on the disk of {place}.")
            self._run("Making a Python environment", _python(), "-m", "venv", self._part)
            self._install()
            self.text, self.fraction = "Checking", None
            python = python_of(self._part)
            if python is None or not has_engine(python):
                raise schema.VibeError("The new environment has no engine in it.", _AGAIN)
            _replace(self.folder, self._part)
        except BaseException as error:
            shutil.rmtree(self._part, ignore_errors=True)
            if self._canceled:
                raise schema.VibeError("Canceled; nothing was installed.", _AGAIN) from None
            if isinstance(error, OSError):
                raise schema.VibeError(f"The engine cannot be set up: {error}.", _AGAIN) from error
            raise
        finally:
            atexit.unregister(self.cancel)

    def _install(self) -> None:
        """Installs the packages; first torch, if it comes from an index of its own."""
        pip = (python_of(self._part), "-m", "pip", "--disable-pip-version-check", "--no-input", "install")
        with contextlib.suppress(schema.VibeError):  # an older pip only reports less progress
            self._run("Updating pip", *pip, "--upgrade", "pip")
        # pip's version is in the name of its dist-info folder.
        names = [p.name for p in self._part.glob("[Ll]ib/**/pip-*.dist-info")]
        found = re.match(r"pip-(\d+)\.(\d+)", max(names, default=""))
        new = found is not None and tuple(map(int, found.groups())) >= (24, 1)
        progress = ("--progress-bar", "raw") if new else ()
        # Compiling thousands of modules would take most of a minute, and the engine uses only some of them.
        pip = (*pip, "--no-compile", *progress)
        if self._build.index:  # first: with both indices at once, pip would take the newer torch
            text = f"Looking for torch at {urlsplit(self._build.index).netloc}"
            self._run(text, *pip, "--index-url", self._build.index, "torch", "torchvision")
        self._run("Looking for packages", *pip, *self._packages)

    def _run(self, text: str, *command: object) -> None:
        """Runs a command; the panel shows `text`, then the progress in its output. Raises VibeError if it fails."""
        if self._canceled:
            raise schema.VibeError("Canceled.", _AGAIN)
        self.text, self.fraction = text, None
        self._process = subprocess.Popen(
            [str(part) for part in command],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            text=True, encoding="utf-8", errors="replace", env=_environment(), **own_group(),
        )  # fmt: skip
        last: collections.deque[str] = collections.deque(maxlen=30)
        with cast(IO[str], self._process.stdout) as output:
            for line in output:
                last.append(line.strip())
                self._follow(line)
        if self._process.wait():
            raise _failure(text, last)

    def _follow(self, line: str) -> None:
        """Updates `text` and `fraction` from a line of pip's output."""
        if match := re.match(r"Progress (\d+) of (\d+)", line):
            done, whole = map(int, match.groups())
            self.fraction = done / whole if whole else None
        elif match := re.match(r"\s*Downloading (?:\S+/)?(\S+?)-(\d\S*?)(?:-\S+)? \((.+)\)", line):
            self.text, self.fraction = f"Downloading {match[1]} ({match[3]})", 0.0
        elif line.startswith("Collecting"):
            self.text, self.fraction = f"Looking for {re.split(r'[<>=!;@ ]', line.split()[1])[0]}", None
        elif line.startswith("Installing collected packages"):
            self.text, self.fraction = f"Installing {line.count(',') + 1} packages, for some minutes", None


def _replace(folder: Path, part: Path) -> None:
    """Moves the finished environment `part` to `folder`, in place of an older one."""
    old = folder.with_name(f"{folder.name}.old")
    shutil.rmtree(old, ignore_errors=True)
    if folder.exists():
        folder.rename(old)
    part.rename(folder)
    shutil.rmtree(old, ignore_errors=True)


def _python() -> Path:
    """The Python to make the environment with: Blender's own, or one on the PATH; raises VibeError if there is none."""
    names = [sys.executable, *(shutil.which(f"python{major}.{minor}") for major, minor in _VERSIONS)]
    probe = f"import sys, ensurepip, venv; sys.exit(sys.version_info[:2] not in {_VERSIONS})"
    for name in filter(None, names):
        with contextlib.suppress(OSError, subprocess.TimeoutExpired):
            done = subprocess.run([name, "-c", probe], capture_output=True, timeout=60, env=_environment())
            if done.returncode == 0:
                return Path(name)
    remedy = "Install Python 3.13 with its venv module (on Debian and Ubuntu: apt install python3-venv)."
    raise schema.VibeError("No Python on this computer can make an environment.", remedy)


def _environment() -> dict[str, str]:
    """The environment variables without those that point Python or pip to Blender's folders."""
    return {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "PIP_TARGET", "VIRTUAL_ENV"))}


def _failure(text: str, lines: collections.deque[str]) -> schema.VibeError:
    """The error for a failed command, which `text` names, from the last `lines` of its output."""
    output = "\n".join(lines)
    if "No space left" in output:
        return schema.VibeError("There is not enough room on the disk.", "Make room, then try again.")
    if re.search(_UNREACHABLE, output):
        host = re.search(r"host='([^']+)'", output)
        message = f"{host[1] if host else 'The package index'} cannot be reached."
        remedy = "Check the network (a proxy or firewall may have to let it through), then try again."
        return schema.VibeError(message, remedy)
    errors = [line.removeprefix("ERROR: ") for line in lines if line.startswith("ERROR")]
    last = next(reversed(errors), next((line for line in reversed(lines) if line), "it said nothing"))
    remedy = _AGAIN
    if "No matching distribution" in output:
        remedy = "Check that pip's index can be reached from here, then press Set Up Engine again."
    return schema.VibeError(f"{text} failed: {last[:200].rstrip('.')}.", remedy)
