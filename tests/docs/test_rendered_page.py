# SPDX-License-Identifier: Apache-2.0
"""The page on what is rendered: each row says how a property is handled, and names a test that exists."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "develop" / "what-is-rendered.md"
BUILDERS = [
    ROOT / "lab" / "blender" / "scenes" / "properties" / f"{name}.py" for name in ("hiding", "lighting", "imaging")
]
FUNCTION = re.compile(r"^def ([a-z]\w+)\(", re.MULTILINE)
PROPERTY = re.compile(r"^def ([a-z]\w+)\(scene: Scene, subject: Object\)", re.MULTILINE)


def rows() -> list[list[str]]:
    """The cells of all tables of properties."""
    lines = PAGE.read_text(encoding="utf-8").split("## Figures")[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    return [row for row in cells if row[0] != "property" and set(row[0]) != {"-"}]


def test_every_row_is_complete_and_its_test_exists():
    paths = [*BUILDERS, *(ROOT / "blender_tests").rglob("*.py")]
    sources = [path.read_text(encoding="utf-8") for path in paths]
    known = {name for source in sources for name in FUNCTION.findall(source)}
    assert rows()
    for name, how, tests in rows():
        assert name
        assert how.startswith(("honored", "reported", "refused")), how
        named = re.findall(r"`(\w+)`", tests)
        assert named, name
        assert set(named) <= known, set(named) - known


def test_every_kind_of_scene_has_a_row():
    built = {name for path in BUILDERS for name in PROPERTY.findall(path.read_text(encoding="utf-8"))}
    assert built
    assert built <= {name for row in rows() for name in re.findall(r"`(\w+)`", row[2])}
