# SPDX-License-Identifier: Apache-2.0
"""Pages that follow the code: generated parts, environment variables, words that do nothing, examples of files."""

import json
import re
import runpy
from pathlib import Path

import pytest

from proxy_renderer.cli.explain import account
from proxy_renderer.schema import VibeError, preset

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PAGES = runpy.run_path(str(DOCS / "pages.py"))
VARIABLE = re.compile(r"\bVIBE_(?!MT_|OT_|PT|UL_|RENDER|VIEWER)[A-Z_]+\b")


def text(page):
    return (DOCS / page).read_text("utf-8")


@pytest.mark.parametrize("page", sorted({page for page, _ in PAGES["PARTS"].values()}))
def test_generated_parts_are_those_of_the_code(page):
    assert PAGES["written_anew"](page, text(page)) == text(page), "run: PYTHONPATH=. python docs/pages.py"


def test_every_environment_variable_is_on_its_page():
    packages = (ROOT / "proxy_renderer", ROOT / "addon" / "vibe_render")
    used = {
        name
        for package in packages
        for path in package.rglob("*.py")
        for name in VARIABLE.findall(path.read_text("utf-8"))
    }
    page = text("reference/environment-variables.md")
    assert used == set(VARIABLE.findall(page))


def test_words_that_do_nothing_do_nothing():
    section = text("guide/prompts.md").split("## Words that do nothing")[1].split("Three kinds")[0]
    rows = re.findall(r"^\| [^|]+ \| ([^|]+) \|$", section, re.M)
    words = [word for row in rows[1:] for word in row.split(", ") if not set(row) <= {"-"}]
    assert len(words) > 20
    for word in words:
        with pytest.raises(VibeError, match="names a look"):
            account(word)


def test_examples_of_the_prompt_guide_are_understood():
    section = text("guide/prompts.md").split("## The form of a prompt")[1].split("\n- ")[0]
    examples = re.findall(r"`([^`]+)`", section)
    assert len(examples) > 9
    for example in examples:
        assert "not used" not in account(example).split("Told to")[0]


def test_the_example_of_a_preset_can_be_read():
    example = re.search(r"^```json\n(.*?)^```$", text("reference/preset-json.md"), re.M | re.S)[1]
    assert preset.loads(example).roles["key"][0]["temperature"] == [2900.0]


def test_fields_of_a_preset_are_on_its_page():
    page = text("reference/preset-json.md")
    written = json.loads(preset.Preset("a", {}).dumps())
    assert [field for field in written if f"| `{field}` |" not in page] == []


def test_fields_of_a_report_are_those_of_the_code():
    packages = (ROOT / "proxy_renderer", ROOT / "addon" / "vibe_render")
    code = "".join(path.read_text("utf-8") for package in packages for path in package.rglob("*.py"))
    page = text("reference/report-json.md")
    names = [name for row in re.findall(r"^\| (`\w+`[^|]*) \|", page, re.M) for name in re.findall(r"`(\w+)`", row)]
    assert len(names) > 40
    assert [name for name in names if f'"{name}"' not in code and f"{name}:" not in code] == []


def data(name):
    return json.loads((DOCS / "results" / name).read_text("utf-8"))


def total(rows, field):
    return sum(row[field] for row in rows)


def test_sums_of_the_sets_are_in_the_results():
    sets, page = data("sealed-sets.json"), text("research/results.md")
    rivals = [row for row in sets["short"] if "rival" in row]
    won, tied, lost = (total([row["rival"] for row in rivals], field) for field in ("won", "tied", "lost"))
    met, theirs = total(rivals, "requests_met"), total([row["rival"] for row in rivals], "requests_met")
    asked = total(rivals, "requests")
    assert f"{total(sets['short'], 'requests_met')} of {total(sets['short'], 'requests')}" in page
    assert f"| {won} | {tied} | {lost} | {met} of {asked} | {theirs} of {asked} |" in page
    assert f"{total(sets['long'], 'requests_met')} of {total(sets['long'], 'requests')}" in page


def test_the_last_sets_are_those_of_the_sums():
    sets = data("sealed-sets.json")
    for row, name in ((sets["short"][-1], "sealed.json"), (sets["long"][0], "sealed-long.json")):
        whole = data(name)
        assert whole["seed"].startswith(row["commit"])
        assert (whole["asks"]["held"], whole["asks"]["asked"]) == (row["requests_met"], row["requests"])


def test_judged_ticks_are_in_the_results():
    page, known = text("research/results.md"), data("judgments.json")
    found = [
        known["all"],
        *(
            {when: known["quantities"][when][q] for when in ("before", "after")}
            for q in ("haze", "substance", "finish")
        ),
    ]
    for row in found:
        both = row["before"], row["after"]
        cells = [f"{each['seen']}/{each['partly']}/{each['not_seen']}" for each in both]
        cells += [f"{each['of_them_ticked']}/{each['judged_visible']}" for each in both]
        assert f"| {' | '.join(cells)} |" in page


def test_rows_of_the_judge_are_in_the_results():
    page, draws = text("research/results.md"), data("judged.json")["draws"]
    for row in draws:
        cells = [f"{row[field]} of {row['cases']}" for field in ("kept", "kept_after_correction")]
        cells += [f"{row[field]} of {row['requests']}" for field in ("visible", "visible_or_partly")]
        assert f"{row['commit']} | {' | '.join(cells)} |" in page
    assert f"{total(draws, 'visible')} of {total(draws, 'requests')}" in page
