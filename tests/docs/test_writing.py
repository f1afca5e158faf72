# SPDX-License-Identifier: Apache-2.0
"""How the documents are written: short sentences and cells, the words of the field, a README that can be read in minutes."""

import re

import pytest
from prose import LONGEST_CELL, LONGEST_SENTENCE, PAGES, ROOT, cells, sentences, unquoted, words, written

REPLACED = {
    "beside": "next to, compared with",
    "by itself": "automatically",
    "by themselves": "automatically",
    "said": "reported",
    "told": "reported, named",
    "mend": "fix",
    "mended": "fixed",
    "foretell": "predict",
    "foretold": "predicted",
    "picture": "image, render",
    "pictures": "images, renders",
    "lamp": "light",
    "lamps": "lights",
    "burnt": "overexposed",
    "letters": "characters",
    "gives way": "is overridden by",
    "give way": "are overridden by",
    "gave way": "was overridden by",
    "motley": "multicolored",
    "things": "objects",
    "meanwhile": "while it runs",
    "very": "leave it out",
    "of which": "rewrite the sentence",
}
"""Words that are hard to read here, and what to write instead."""


def replaced(text):
    """Words of the list that a text has."""
    plain = unquoted(text).lower()
    return [word for word in REPLACED if re.search(rf"(?<![\w-]){word}(?![\w-])", plain)]


def name(page):
    return page.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_sentences_and_cells_are_short(page):
    text = written(page.read_text("utf-8"))
    assert [each for each in sentences(text) if words(each) > LONGEST_SENTENCE] == []
    assert [each for each in cells(text) if words(each) > LONGEST_CELL] == []


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_words_are_those_of_the_field(page):
    text = written(page.read_text("utf-8"))
    found = {line.strip(): bad for line in unquoted(text).splitlines() if (bad := replaced(line))}
    assert {line: {word: REPLACED[word] for word in bad} for line, bad in found.items()} == {}


def test_the_readme_is_short():
    text = (ROOT / "README.md").read_text("utf-8")
    plain = written(text)
    assert words(re.sub(r"^ *```.*?^ *```$", "", text, flags=re.M | re.S)) <= 700
    assert [cell for cell in cells(plain) if words(cell) > 12] == []
    tables = re.findall(r"(?:^\|.*\n)+", plain, re.M)
    assert tables
    assert all(len(table.splitlines()) <= 10 for table in tables)  # eight rows, their titles and a line


def test_the_results_are_short():
    assert words((ROOT / "docs/research/results.md").read_text("utf-8")) <= 2500


def test_figures_of_the_readme_are_in_the_results():
    section = (ROOT / "README.md").read_text("utf-8").split("## How well does it work?")[1].split("\n## ")[0]
    results = (ROOT / "docs/research/results.md").read_text("utf-8")
    figures = set(re.findall(r"\d+(?:[.,]\d+)*", section)) - {"2000", "1"}
    assert len(figures) > 10
    assert [figure for figure in figures if not re.search(rf"(?<![\d.,]){figure}(?![\d]|[.,]\d)", results)] == []


def test_the_checks_can_fail():
    page = written("A `x y z` b. \"Very\" *things* 'c'.\n\n```\nlong\n```\n| a b | beside the lamp |\n")
    assert cells(page) == ["a b", "beside the lamp"]
    assert sentences(page)[0] == "A Code b."
    assert replaced(page) == ["beside", "lamp"]
    assert words("one two – 3") == 3
