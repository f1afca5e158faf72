# SPDX-License-Identifier: Apache-2.0
"""The built wheel: all that an installed copy reads, nothing that cannot be reached, nothing that a run or a test has left behind."""

import zipfile
from pathlib import Path

import pytest
from hatchling.build import build_wheel
from reach import unreachable

ROOT = Path(__file__).parents[1]
PLACES = {"proxy_renderer": ROOT / "proxy_renderer", "vibe_render": ROOT / "addon" / "vibe_render"}
ENTRIES = (
    "proxy_renderer.cli.main",
    "proxy_renderer.cli.__main__",
    "proxy_renderer.engine.worker",
    "vibe_render",
    "vibe_render.batch",
)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """A folder with all files of a wheel that is built from this clone."""
    folder = tmp_path_factory.mktemp("wheel")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        name = build_wheel(str(folder))
    with zipfile.ZipFile(folder / name) as archive:
        archive.extractall(folder / "all")
    return folder / "all"


def files(folder):
    """Names of a folder's files, as the wheel has them."""
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def in_clone():
    """Names of all that the clone's packages hold, but documents and what Python leaves behind."""
    found = {f"{name}/{each}" for name, folder in PLACES.items() for each in files(folder)}
    return {name for name in found if not name.endswith((".pyc", ".md"))}


def test_the_wheel_holds_all_of_its_packages_and_nothing_else(wheel):
    its_own = {name for name in files(wheel) if ".dist-info/" not in name}
    assert its_own == in_clone()


def test_all_of_it_can_be_reached(wheel):
    assert not unreachable(wheel, PLACES, ENTRIES)


def test_what_nothing_reaches_is_noticed(wheel):
    strays = {
        "proxy_renderer/render/nobody.py",
        "proxy_renderer/train/__init__.py",
        "proxy_renderer/guidance/judge/heads.safetensors",
        "proxy_renderer/guidance/embedded/heads.safetensors",
        "proxy_renderer/words/lexicon/verbs.txt",
        "proxy_renderer/batch/page/index.txt",
        "vibe_render/looks/shipped/noir.png",
        "vibe_render/looks/shipped/prompts.toml",
    }
    for stray in strays:
        (wheel / stray).parent.mkdir(exist_ok=True)
        (wheel / stray).write_text("import proxy_renderer\n")
    assert unreachable(wheel, PLACES, ENTRIES) == strays
