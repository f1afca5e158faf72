# SPDX-License-Identifier: Apache-2.0
"""`vibe doctor`: checks the parts of the installation, and says what to do about those that do not work."""

import importlib
import json
import platform
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from types import ModuleType

from .. import __version__
from ..schema import VibeError
from ..schema.messages import Options
from ..vlm.endpoint import Endpoint, find_endpoint

_BLENDER = (
    "import bpy, json, os; print('BLENDER ' + json.dumps([bpy.app.version_string, "
    "os.path.join(bpy.utils.system_resource('DATAFILES'), 'colormanagement', 'config.ocio')]))"
)
_FORMATS = {"json_schema": "strict JSON", "text": "JSON in plain text"}
_AGAIN = "Install it again: `pip install .` in a clone of Vibe Render."


def examine() -> int:
    """Runs every check, prints a line each, and returns 0 if a vibe can be run, otherwise 2."""
    print(f"vibe-render {__version__}", flush=True)
    config: list[str] = []
    checks: list[tuple[str, Callable[[], str]]] = [
        ("Python", _python), ("Blender", lambda: _blender(config)), ("torch", _torch), ("rays", _rays),
        ("color", lambda: _ocio(config)), ("encoder", _encoder), ("folders", _folders), ("model", _model),
    ]  # fmt: skip
    broken = 0
    for name, act in checks:
        try:
            print(f"  ok    {name:8} {act()}", flush=True)
        except VibeError as error:
            broken += 1
            print(f"  FIX   {name:8} {error.message}\n                 -> {error.remedy}", flush=True)
    print("All is well. Try `vibe demo`." if not broken else f"{broken} to fix.")
    return 2 if broken else 0


def _python() -> str:
    version = sys.version_info[:2]
    if version not in ((3, 11), (3, 13)):
        remedy = "Use Python 3.13 (Blender 5.2 LTS) or 3.11 (Blender 4.5 LTS)."
        raise VibeError(f"Python {platform.python_version()} has no Blender module.", remedy)
    return f"{platform.python_version()}, {platform.system()} {platform.machine()}"


def _blender(config: list[str]) -> str:
    """Blender's version, from a process of its own; the path of its color configuration is added to `config`."""
    try:
        done = subprocess.run([sys.executable, "-c", _BLENDER], capture_output=True, text=True, timeout=120)
    except subprocess.TimeoutExpired as error:
        raise VibeError("Blender's module does not start within two minutes.", _AGAIN) from error
    lines = [line for line in done.stdout.splitlines() if line.startswith("BLENDER ")]
    if not lines:
        reason = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        remedy = f"If a lib*.so is missing, install it with your system's package manager; otherwise {_AGAIN}"
        raise VibeError(f"Blender's module does not start: {reason[:150]}", remedy)
    version, path = json.loads(lines[0].removeprefix("BLENDER "))
    config.append(path)
    return f"{version} (the bpy module)"


def _imported(what: str, remedy: str, *names: str) -> ModuleType:
    try:
        return [importlib.import_module(name) for name in names][-1]
    except (ImportError, OSError) as error:
        raise VibeError(f"{what} cannot be imported: {error}", remedy) from error


def _torch() -> str:
    torch = _imported("torch", _AGAIN, "torch")
    cards = [f"cuda:{i} {torch.cuda.get_device_name(i)}" for i in range(torch.cuda.device_count())]
    shown = ", ".join(cards) or "no graphics card (the CPU is fine)"
    return f"{torch.__version__}, {torch.get_num_threads()} threads, {shown}"


def _rays() -> str:
    _imported("What reads meshes", "pip install embreex trimesh dracopy", "DracoPy", "embreex", "trimesh")
    return ", ".join(f"{name} {metadata.version(name)}" for name in ("embreex", "trimesh", "dracopy"))


def _ocio(config: list[str]) -> str:
    ocio = _imported("OpenColorIO", "pip install opencolorio", "PyOpenColorIO")
    if not config:
        return f"OpenColorIO {ocio.__version__}"
    views = list(ocio.Config.CreateFromFile(config[0]).getViews("sRGB"))
    return f"OpenColorIO {ocio.__version__} reads Blender's {len(views)} views"


def _encoder() -> str:
    from ..guidance.encoder import load_encoder

    encoder = load_encoder(None, "cpu")
    return f"{encoder.name}, {encoder.size} pixels"


def _model() -> str:
    """A line on a model's answer to one cheap question with an image, or a line that no model is configured."""
    if endpoint := find_endpoint(Options()):
        return try_model(endpoint)
    return "none, the offline planner does without (VIBE_VLM_MODEL names one)"


def try_model(endpoint: Endpoint) -> str:
    """Shows the model a red square; returns a line on its answer, the request format that it takes, and the time."""
    from PIL import Image

    from ..vlm.client import Client, Question, jpeg_of
    from ..vlm.request import json_object
    from ..vlm.transport import clean

    client = Client(endpoint)
    square = jpeg_of(Image.new("RGB", (64, 64), (220, 20, 20)))
    system = 'Name the color of the square in one word, as {"color": "..."}. Say "unseen" if there is no picture.'
    question = Question(system, "What color is it?", square, json_object(color={"type": "string"}))
    color = clean(client.ask(question, fresh=True).get("color"), 40)
    sees = "red" in color.lower() and client.dialect.pictures
    eyesight = "sees pictures" if sees else "does NOT see pictures: it plans from numbers, and cannot judge"
    return (
        f"{endpoint.model} at {endpoint.place} answers {color!r} to a red square in {client.usage.seconds:.1f} s: "
        f"{eyesight}; {_FORMATS[client.dialect.format]}"
    )


def _folders() -> str:
    for folder in (Path(tempfile.gettempdir()), Path.cwd()):
        try:
            with tempfile.TemporaryFile(dir=folder):
                pass
        except OSError as error:
            remedy = "Change to a folder of yours, or set TMPDIR."
            raise VibeError(f"{folder} cannot be written ({error.strerror}).", remedy) from error
    return "the temporary and the current folder can be written"
