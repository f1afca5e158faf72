# SPDX-License-Identifier: Apache-2.0
"""The documents: links lead somewhere, commands parse, files that they name are there, examples in docstrings are right."""

import doctest
import importlib
import importlib.util
import re
import runpy
import shlex
import tomllib
from pathlib import Path

import pytest
from imports import modules

from proxy_renderer import __version__
from proxy_renderer.cli.main import _arguments
from proxy_renderer.schema import VibeError

ROOT = Path(__file__).parents[1]
PAGES = sorted(
    path.relative_to(ROOT).as_posix()
    for pattern in ("*.md", ".github/**/*.md", "docs/**/*.md", "LICENSES/*.md", "proxy_renderer/**/*.md", "lab/**/*.md")
    for path in ROOT.glob(pattern)
)
FENCE = re.compile(r"^ *```(\w*)\n(.*?)^ *```$", re.M | re.S)


def text(page):
    return (ROOT / page).read_text(encoding="utf-8")


def prose(markdown):
    """A page without its code."""
    return FENCE.sub("", markdown)


def anchors(markdown):
    """What a page's headings are linked by."""
    headings = re.findall(r"^#+ +(.+?) *$", prose(markdown), re.M)
    plain = (re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading) for heading in headings)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in plain}


def dead_links(page, markdown):
    """Relative links of a page that lead nowhere."""
    plain = re.sub(r"`[^`\n]*`", "", prose(markdown))
    targets = re.findall(r"\]\(([^)\s]+)\)", plain) + re.findall(r"(?:src|href)=\"([^\"]+)\"", plain)
    dead = []
    for target in targets:
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        file = (ROOT / page).parent / path if path else ROOT / page
        there = file.exists()
        if not there or (anchor and anchor not in anchors(text(file) if path else markdown)):
            dead.append(target)
    return dead


def commands(markdown):
    """Command lines of `vibe` in a page's blocks."""
    lines = (line for _, block in FENCE.findall(markdown) for line in block.replace("\\\n", " ").splitlines())
    return [line.strip() for line in lines if re.match(r"\s*(\$ )?vibe ", line)]


def wrong_commands(markdown):
    """Command lines that `vibe` does not take."""
    wrong = []
    for line in commands(markdown):
        try:
            words = shlex.split(line.removeprefix("$ "), comments=True)
            _arguments(words[1 : words.index(">") if ">" in words else None])
        except (SystemExit, VibeError):
            wrong.append(line)
    return wrong


def missing_modules(markdown):
    """Modules after `python -m`, in text and in blocks, that Python does not find."""
    named = set(re.findall(r"python3? -m ([\w.]*\w)", markdown))
    return sorted(name for name in named if importlib.util.find_spec(name.split(".")[0]) is None or not found(name))


def found(name):
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:
        return False


def missing_files(page, markdown):
    """Source files in backquotes, by their path from the repository or a package, that do not exist."""
    roots = (ROOT, ROOT / "proxy_renderer", ROOT / "addon" / "vibe_render", ROOT / "lab", (ROOT / page).parent)
    named = re.findall(r"`([\w.-]+(?:/[\w.-]+)+\.(?:py|toml|txt|md))`", prose(markdown))
    return [name for name in named if not any((root / name).exists() for root in roots)]


@pytest.mark.parametrize("page", PAGES)
def test_links_lead_somewhere(page):
    assert dead_links(page, text(page)) == []


@pytest.mark.parametrize("page", PAGES)
def test_commands_parse(page):
    assert wrong_commands(text(page)) == []


@pytest.mark.parametrize("page", PAGES)
def test_modules_that_are_run_exist(page):
    assert missing_modules(text(page)) == []


@pytest.mark.parametrize("page", PAGES)
def test_files_that_are_named_exist(page):
    assert missing_files(page, text(page)) == []


def test_there_are_commands_to_parse():
    assert len([line for page in PAGES for line in commands(text(page))]) > 10


EXAMPLES = [
    name
    for name, path in modules(ROOT / "proxy_renderer").items()
    if re.search(r"^\s*>>> ", path.read_text(encoding="utf-8"), re.M)
]


@pytest.mark.parametrize("module", EXAMPLES)
def test_examples_in_docstrings(module):
    results = doctest.testmod(importlib.import_module(module), optionflags=doctest.ELLIPSIS)
    assert results.attempted
    assert not results.failed


def test_a_release_needs_its_entry_in_the_changelog(capsys):
    main = runpy.run_path(str(ROOT / ".ci" / "release_notes.py"))["main"]
    assert main(f"v{__version__}") == 0
    assert "Added" in capsys.readouterr().out
    assert main("v0.0.1") == 1
    assert "0.0.1" in capsys.readouterr().err


def test_the_extension_has_the_version_of_the_code_and_names_the_oldest_blender_that_is_tested():
    manifest = tomllib.loads(text("addon/vibe_render/blender_manifest.toml"))
    assert manifest["version"] == __version__
    needed = tomllib.loads(text("pyproject.toml"))["project"]["dependencies"]
    tested = sorted(re.search(r"==(\d+\.\d+)", line)[1] for line in needed if line.startswith("bpy"))
    assert manifest["blender_version_min"] == f"{tested[0]}.0"
    assert all(f"Blender {version} LTS" in text("docs/install.md") for version in tested)


def test_the_checks_can_fail():
    page = "# One, two\n[a](#one-two) [b](#three) [c](nowhere.md) [d](README.md#no) `cli/nothing.py` `cli/main.py`\n"
    block = "```\nvibe run a.blend --prompt x --out y # noted\nvibe run --frobnicate > c\n```\n"
    assert dead_links("README.md", page + block) == ["#three", "nowhere.md", "README.md#no"]
    assert missing_files("README.md", page) == ["cli/nothing.py"]
    assert wrong_commands(page + block) == ["vibe run --frobnicate > c"]
    assert missing_modules("`python -m proxy_renderer.nothing`, python -m lab x") == ["proxy_renderer.nothing"]
