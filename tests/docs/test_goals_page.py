# SPDX-License-Identifier: Apache-2.0
"""docs/reference/goals.md has all fields, quantities, classes and measures; its example is what `vibe explain --goals` writes.

`python tests/docs/test_goals_page.py` writes the page's tables and its example anew.
"""

import inspect
import json
import math
import re
from collections.abc import Iterator
from pathlib import Path

from proxy_renderer.claims.measures import MEASURES
from proxy_renderer.cli.explain import account
from proxy_renderer.goals import written
from proxy_renderer.words.lexicon.entries import COLOR_MODES, OWNERS, RANGE_MODES, SLOTS
from proxy_renderer.words.lexicon.quantities import quantities
from proxy_renderer.words.types import SceneDescription

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "goals.md"
PROMPT = "copper cup, cool light, golden hour"
"""Of the example."""


def table(*rows: tuple[str, ...]) -> str:
    """A table in Markdown; the first row has the titles."""
    titles, *others = rows
    return "\n".join(f"| {' | '.join(row)} |" for row in (titles, ("---",) * len(titles), *others))


def code(names) -> str:
    return ", ".join(f"`{name}`" for name in names)


def of_quantities() -> Iterator[tuple[str, ...]]:
    known = quantities()
    yield "quantity", "in sentences", "classes", "parameters that serve it", "measures"
    for name, quantity in known.by_name.items():
        rows = [[key for key, owner in each.items() if owner == name] for each in (known.parameters, known.measures)]
        yield f"`{name}`", quantity.says, code(quantity.classes), *map(code, rows)


def of_classes() -> Iterator[tuple[str, ...]]:
    yield "quantity", "class", "what the image has to look like"
    for name, quantity in quantities().by_name.items():
        for named, claims in quantity.classes.items():
            if claims:
                yield f"`{name}`", f"`{named}`", code(claims)


def of_measures() -> Iterator[tuple[str, ...]]:
    yield "measure", "what it is", "unit", "noticeable difference", "seen from"
    seen = quantities().seen
    for name, measure in MEASURES.items():
        steps = seen.get(name, 1.0)
        told = f"{steps:g}" if math.isfinite(steps) else "never"
        yield f"`{name}`", measure.says, measure.unit, f"{measure.notice:g}", told


TABLES = {"quantities": of_quantities, "classes": of_classes, "measures": of_measures}


WIDE = 118
"""Characters of a line of the example."""


def compact(value: object, indent: int = 0, before: int = 0) -> str:
    """JSON with what fits on one line."""
    line, more = json.dumps(value, ensure_ascii=False), " " * (indent + 2)
    if not value or not isinstance(value, dict | list) or (indent and len(line) + indent + before < WIDE):
        return line
    if isinstance(value, dict):
        ends, names = "{}", [f"{json.dumps(name)}: " for name in value]
        rows = [name + compact(each, indent + 2, len(name)) for name, each in zip(names, value.values(), strict=True)]
    else:
        ends, rows = "[]", [compact(each, indent + 2) for each in value]
    return f"{ends[0]}\n{more}" + f",\n{more}".join(rows) + f"\n{' ' * indent}{ends[1]}"


def written_anew(text: str) -> str:
    """The page with its tables and its example as the code has them."""
    for name, rows in TABLES.items():
        new = f"<!-- {name} -->\n{table(*rows())}\n<!-- /{name} -->"
        text, found = re.subn(rf"<!-- {name} -->\n.*?<!-- /{name} -->", lambda _, new=new: new, text, flags=re.S)
        assert found == 1, name
    example = f"```json\n{compact(explained())}\n```"
    return re.sub(r"^```json\n.*?^```$", lambda _: example, text, count=1, flags=re.M | re.S)


def explained() -> dict:
    """The goals of the example."""
    return json.loads(account(PROMPT, "goals"))


def examples() -> list[dict]:
    return [json.loads(block) for block in re.findall(r"^```json\n(.*?)^```$", PAGE.read_text("utf-8"), re.M | re.S)]


def test_the_tables_and_the_example_are_the_code_s():
    page = PAGE.read_text("utf-8")
    assert written_anew(page) == page, "run: python tests/docs/test_goals_page.py"


def test_every_field_is_named():
    taken = r'\.(?:take|number|numbers|choice|texts|each|named)\("(\w+)"'
    fields = set(re.findall(taken, inspect.getsource(written)))
    assert len(fields) > 20
    assert [name for name in fields if f"| `{name}` |" not in PAGE.read_text("utf-8")] == []


def test_every_choice_is_named():
    text = PAGE.read_text("utf-8")
    choices = (*SLOTS, *written.KINDS, *written.ROLES, *RANGE_MODES, *COLOR_MODES, *OWNERS)
    assert [name for name in choices if name and f"`{name}`" not in text] == []


def test_the_example_is_what_explain_writes():
    assert examples()[0] == explained()


def test_every_example_can_be_read():
    assert len(examples()) > 1
    for example in examples():
        assert written.from_json(example).within(SceneDescription()).wishes


if __name__ == "__main__":
    PAGE.write_text(written_anew(PAGE.read_text("utf-8")), encoding="utf-8")
