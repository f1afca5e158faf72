# SPDX-License-Identifier: Apache-2.0
"""The built wheel: it holds everything that an installed copy reads, and nothing that a run or a test has left behind."""

import sys
import zipfile
from pathlib import Path

import pytest
from hatchling.build import build_wheel

ROOT = Path(__file__).parents[1]
PLACES = {"proxy_renderer": "proxy_renderer", "vibe_render": "addon/vibe_render"}
_ENCODER = (
    "heads.json",
    "heads.safetensors",
    "merges.txt.gz",
    "open_clip_config.json",
    "open_clip_model.safetensors",
    "README.md",
)
DATA = (
    "proxy_renderer/py.typed",
    "vibe_render/py.typed",
    "vibe_render/blender_manifest.toml",
    *(f"proxy_renderer/guidance/embedded/{name}" for name in _ENCODER),
    "proxy_renderer/guidance/embedded/skill.json",
    "proxy_renderer/prompt/lexicon/binding.json",
    "proxy_renderer/prompt/lexicon/colors.txt",
    "proxy_renderer/prompt/lexicon/hours.toml",
    "proxy_renderer/prompt/lexicon/things.toml",
    "proxy_renderer/prompt/lexicon/names.toml",
    "proxy_renderer/prompt/lexicon/modifiers.toml",
    "proxy_renderer/prompt/lexicon/rigs.toml",
    "proxy_renderer/prompt/lexicon/vocabulary.toml",
    "proxy_renderer/prompt/lexicon/words.safetensors",
    "proxy_renderer/prompt/languages/*.toml",
    "proxy_renderer/prompt/languages/unread.txt",
    "proxy_renderer/claims/heads.toml",
    "proxy_renderer/batch/flamenco.js",
    "proxy_renderer/batch/page/*.js",
    "proxy_renderer/batch/page/*.css",
    "proxy_renderer/batch/page/*.html",
    "vibe_render/looks/shipped/*.jpg",
    "vibe_render/looks/shipped/*.json",
)
"""All files beside the modules: the wheel's places, with * for a name. A new kind of data gets a line here."""


def in_tree(pattern):
    """What the clone has of a pattern, as the wheel names it."""
    package, _, rest = pattern.partition("/")
    folder = ROOT / PLACES[package]
    return {
        f"{package}/{path.relative_to(folder).as_posix()}" for path in folder.glob(rest) if path.is_file()
    }


def missing(names):
    """Patterns that match nothing, and files of the clone that a wheel lacks."""
    sought = (*DATA, *(f"{package}/**/*.py" for package in PLACES))
    files = {pattern: in_tree(pattern) for pattern in sought}
    return {pattern for pattern in sought if not files[pattern]} | set().union(*files.values()) - names


def strange(names):
    """What is neither a module, nor known data, nor the wheel's own description."""
    data = {file for pattern in DATA for file in in_tree(pattern)}
    return {name for name in names - data if not (".dist-info/" in name or is_module(name))}


def is_module(name):
    return name.partition("/")[0] in PLACES and name.endswith(".py")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The names of all files in a wheel that is built from this clone."""
    folder = tmp_path_factory.mktemp("wheel")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(ROOT)
        name = build_wheel(str(folder))
    with zipfile.ZipFile(folder / name) as archive:
        return set(archive.namelist())


def test_the_wheel_is_whole(wheel):
    assert not missing(wheel)


def test_the_wheel_holds_nothing_else(wheel):
    assert not strange(wheel)


def test_a_wheel_without_a_file_is_not_whole(wheel):
    lost = {min(in_tree(pattern)) for pattern in DATA}
    assert missing(wheel - lost) == lost


def test_data_that_the_clone_has_lost_is_missed(wheel, monkeypatch):
    monkeypatch.setattr(sys.modules[__name__], "DATA", (*DATA, "proxy_renderer/prompt/lexicon/verbs.txt"))
    assert missing(wheel) == {"proxy_renderer/prompt/lexicon/verbs.txt"}


@pytest.mark.parametrize(
    "stray",
    [
        "tests/test_wheel.py",
        "blender_tests/dump.py",
        "out/vibed.blend",
        "proxy_renderer/render/__pycache__/proxy.cpython-313.pyc",
        "proxy_renderer/batch/page/index.txt",
        "lab/train/sentences/development/scenes.toml",
        "vibe_render/looks/shipped/noir.png",
    ],
)
def test_output_in_a_wheel_is_noticed(wheel, stray):
    assert strange(wheel | {stray}) == {stray}
