# SPDX-License-Identifier: Apache-2.0
"""Prints the changelog's entry for a tag: `python .ci/release_notes.py v0.1.0`.

Fails where there is none, or where the tag is not the version of the code.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def notes(changelog: str, version: str) -> str:
    """The text below `## [version]`, up to the next version; empty where there is none."""
    entry = re.search(rf"^## \[?{re.escape(version)}\]?[^\n]*\n(.*?)(?=^## |^\[[^\]]+\]: |\Z)", changelog, re.M | re.S)
    return entry[1].strip() if entry else ""


def main(tag: str) -> int:
    """Prints the entry; returns 1, with the reason, if this cannot be released."""
    version = tag.removeprefix("v")
    code = re.search(r'__version__ = "(.+)"', (ROOT / "proxy_renderer" / "__init__.py").read_text("utf-8"))[1]
    text = notes((ROOT / "CHANGELOG.md").read_text("utf-8"), version)
    if version != code:
        print(f"The tag is {tag}, and the code says {code}.", file=sys.stderr)
    elif not text:
        print(f"CHANGELOG.md has no entry for {version}: add one below its title.", file=sys.stderr)
    print(text)
    return int(version != code or not text)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
