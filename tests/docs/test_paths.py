# SPDX-License-Identifier: Apache-2.0
"""Every file, folder and function that the documents name is there."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md", *sorted((ROOT / "docs").glob("**/*.md"))]
PAGES += (
    sorted((ROOT / "LICENSES").glob("*.md"))
    + sorted((ROOT / "proxy_renderer").glob("**/README.md"))
    + sorted((ROOT / "lab").glob("**/README.md"))
)
BASES = (ROOT, ROOT / "proxy_renderer", ROOT / "proxy_renderer" / "words", ROOT / "addon" / "vibe_render", ROOT / "lab")
"""What paths in documents are relative to."""
TOPS = {p.name for base in BASES for p in base.iterdir() if p.is_dir()}
PATH = re.compile(r"`((?:[\w.-]+/)+[\w.-]*|\w+\.(?:py|toml))`(?:, `(\w+)(?:\.(?!py)\w+)?`)?")

NAME_IN_PATH = re.compile(r"`([A-Za-z_]\w+)`(?: and `\w+`)* (?:in|of) `((?:[\w.-]+/)+[\w.-]+\.py)`")


def named(page: Path) -> list[tuple[str, str]]:
    """The paths that a page names, with the function or class that it names right after one."""
    found = PATH.findall(page.read_text(encoding="utf-8"))
    found += [(path, name) for name, path in NAME_IN_PATH.findall(page.read_text(encoding="utf-8"))]
    return [(path, name) for path, name in found if path.partition("/")[0] in TOPS or path.endswith(".py")]


def missing(path: str, name: str, folder: Path) -> str:
    """What is not there; "" if all of it is."""
    places = [base / path for base in (*BASES, folder) if (base / path).exists()]
    if not places and "/" not in path:  # a module named by its file alone
        places = [p for base in (ROOT / "proxy_renderer", ROOT / "addon", ROOT / "tests") for p in base.rglob(path)]
    if not places:
        return path
    texts = [p.read_text(encoding="utf-8") for p in places if p.suffix == ".py"]
    defined = re.compile(rf"^\s*(?:def|class) {name}\b|^{name}\b.*=", re.MULTILINE)
    return "" if not name or not texts or any(map(defined.search, texts)) else f"{path}, {name}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_a_page_names_is_there(page):
    gone = [m for path, name in named(page) if (m := missing(path, name, page.parent))]
    assert not gone


def test_the_check_can_fail():
    assert missing("proxy_renderer/nowhere.py", "", ROOT)
    assert missing("proxy_renderer/schema/parameters.py", "nothing", ROOT)
    assert not missing("proxy_renderer/schema/parameters.py", "schema_hash", ROOT)
    assert len(named(ROOT / "docs" / "develop" / "architecture.md")) > 30
