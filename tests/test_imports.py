# SPDX-License-Identifier: Apache-2.0
"""Who may import whom, proven in processes of their own; and the proof itself is shown to be able to fail."""

import subprocess
import sys
from pathlib import Path

import pytest
from imports import imported

ROOT = Path(__file__).parents[1]
ENGINE, ADDON = ROOT / "proxy_renderer", ROOT / "addon" / "vibe_render"
HEAVY = ("torch", "open_clip", "trimesh", "numpy", "PIL", "rich", "openai")


def tops(path):
    """Top-level packages that a file imports anywhere in it, also inside functions; "." for relative imports."""
    return {target.split(".")[0] or "." for target in imported(path)}


def offenders(folder, forbidden):
    """Files in a folder that import something forbidden, with what they import."""
    files = [p for p in folder.rglob("*.py") if "__pycache__" not in p.parts]
    assert files, folder
    return {str(p.relative_to(ROOT)): bad for p in files if (bad := tops(p) & set(forbidden))}


def loaded(code, names):
    """Which of the modules are loaded after the code has run in a fresh process."""
    check = f"{code}\nimport sys\nprint(*[n for n in {names!r} if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", check], cwd=ROOT, capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_the_engine_never_imports_blender():
    assert not offenders(ENGINE, ["bpy", "mathutils", "bpy_extras", "gpu", "vibe_render"])


def test_nothing_shipped_imports_the_laboratory():
    assert not offenders(ENGINE, ["lab"])
    assert not offenders(ADDON, ["lab"])


def test_the_addon_never_imports_what_blender_does_not_have():
    assert not offenders(
        ADDON, ["torch", "torchvision", "open_clip", "trimesh", "embreex", "PIL", "scipy", "PyOpenColorIO"]
    )


def test_the_schema_is_standard_library_and_relative_imports_only():
    allowed = {".", "__future__", *sys.stdlib_module_names}
    files = list((ENGINE / "schema").glob("*.py"))
    assert files
    assert not {p.name: bad for p in files if (bad := tops(p) - allowed)}


@pytest.mark.parametrize(
    "code",
    [
        "import proxy_renderer",
        "import proxy_renderer.cli.main as c; c.parser()",
        "import proxy_renderer.planning.planner, proxy_renderer.words.parser",
        "import proxy_renderer.engine.worker",
    ],
)
def test_starting_loads_nothing_heavy(code):
    assert loaded(code, HEAVY) == []


def test_the_whole_engine_runs_without_blender():
    assert loaded("import proxy_renderer.engine.session, proxy_renderer.cli.doctor", ["torch", "bpy"]) == ["torch"]


def test_the_checks_can_fail(tmp_path):
    culprit = tmp_path / "bad.py"
    culprit.write_text(
        "def later():\n    from bpy.types import Scene\n    import torch.nn as nn\n    import lab.bench\n"
    )
    assert tops(culprit) == {"bpy", "torch", "lab"}
    assert loaded("import numpy", HEAVY) == ["numpy"]
