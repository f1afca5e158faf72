# SPDX-License-Identifier: Apache-2.0
"""The prose of the documents: sentences and cells of tables, without code, quotations and generated parts."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGES = [
    *(path for path in sorted(ROOT.glob("*.md")) if path.name != "CHANGELOG.md"),
    *sorted((ROOT / "docs").glob("**/*.md")),
    *sorted((ROOT / "LICENSES").glob("*.md")),
    *sorted((ROOT / "proxy_renderer").glob("**/*.md")),
    *sorted((ROOT / "lab").glob("**/*.md")),
]
LONGEST_SENTENCE, LONGEST_CELL = 40, 20
"""Words."""


def written(markdown: str) -> str:
    """A page without code blocks, generated parts and comments; code in backquotes and targets of links are one word."""
    text = re.sub(r"^ *```.*?^ *```$", "", markdown, flags=re.M | re.S)
    text = re.sub(r"<!-- ([\w ]+) -->.*?<!-- /\1 -->", "", text, flags=re.S)
    text = re.sub(r"<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"`[^`]*`", "Code", text)


def cells(text: str) -> list[str]:
    """The cells of all tables."""
    rows = (line.strip() for line in text.splitlines() if line.lstrip().startswith("|"))
    return [cell.strip() for row in rows for cell in re.split(r"(?<!\\)\|", row.strip("|"))]


def sentences(text: str) -> list[str]:
    """The sentences of all paragraphs and items of lists."""
    lines = [line for line in text.splitlines() if not re.match(r"\s*(\||#)", line)]
    blocks = re.split(r"\n\s*\n|\n(?=\s*(?:[-*]|\d+\.) )", "\n".join(lines))
    found = []
    for block in blocks:
        flat = " ".join(block.split())
        found += re.split(r"(?<=[.!?])[\"”)*]* (?=[A-Z“\"`(\[*0-9])", flat)
    return [sentence for sentence in found if sentence]


def words(text: str) -> int:
    """How many words a text has."""
    return len([word for word in text.split() if re.search(r"\w", word)])


def unquoted(text: str) -> str:
    """A text without what stands in quotation marks or in italics: prompts and names of buttons."""
    return re.sub(r"\"[^\"\n]*\"|“[^”]*”|(?<!\*)\*(?!\*)[^*\n]+\*(?!\*)", "", text)
