# SPDX-License-Identifier: Apache-2.0
"""The architecture, proven from the imports: which folder may import which, and that no two modules need each other."""

import ast
from collections import Counter, defaultdict
from pathlib import Path

import pytest
from imports import circles, folder, module_graph, modules

ROOT = Path(__file__).parents[1]
PACKAGES = {
    "proxy_renderer": ROOT / "proxy_renderer",
    "vibe_render": ROOT / "addon" / "vibe_render",
    "lab": ROOT / "lab",
}

# Folders of each package, lowest first: a module imports from its own folder and from those above it in this list.
# Two joined by = are one room in two parts, on the same layer.
LAYERS = {
    "proxy_renderer": """
        schema=schema.options . blender color scene
        words.lexicon words goals planning vlm inputs batch
        render.geometry render.material render.lights render.transport render.surface render claims.measures claims rigs reference
        guidance optimize=optimize.rounds engine
        cli
    """,
    "vibe_render": """
        core engine scene.geometry scene.nodes scene render export run looks headless ui
        .
    """,
    "lab": """
        blender.scenes.properties blender.scenes blender blender.like judge heads methods train.sentences train.pictures train.text train
        bench.mitsuba bench bench.speed bench.encoder bench.paper bench.ladder bench.wild bench.sealed bench.scale bench.materials
        bench.binding bench.like .
    """,
}
# Modules of a folder without its __init__: what one still reads as a list. One more asks for a folder.
WIDEST = 18


def layers(package: str) -> dict[str, int]:
    """Dotted names of a package's folders, with their layer; 0 is the lowest."""
    rooms = (room.split("=") for room in LAYERS[package].split())
    return {
        package if name == "." else f"{package}.{name}": level for level, names in enumerate(rooms) for name in names
    }


def upward(files, level):
    """Imports from a lower folder to a higher one: {(module, imported module)}."""
    return {
        (name, target)
        for name, targets in module_graph(files).items()
        for target in targets
        if level[folder(target, files)] > level[folder(name, files)]
    }


def wide(files):
    """Folders with more modules than one reads as a list, with their number."""
    counts = Counter(folder(name, files) for name, path in files.items() if path.name != "__init__.py")
    return {name: count for name, count in counts.items() if count > WIDEST}


def class_names(files):
    """Public classes and type aliases at the top of modules: name to the modules that define it."""
    homes = defaultdict(set)
    for module, path in files.items():
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ClassDef) or (isinstance(node, ast.Assign) and _is_alias(node)):
                homes[node.name if isinstance(node, ast.ClassDef) else node.targets[0].id].add(module)
    return {name: found for name, found in homes.items() if not name.startswith("_")}


def _is_alias(node: ast.Assign) -> bool:
    """Whether an assignment names a type: `Rows = list[Row]`, `Number = int | float`."""
    target = node.targets[0]
    named = isinstance(target, ast.Name) and not target.id.isupper() and target.id[:1].isupper()
    return named and isinstance(node.value, ast.Subscript | ast.BinOp | ast.Name | ast.Attribute)


def twice(names):
    """Names with more than one home."""
    return {name: sorted(homes) for name, homes in names.items() if len(homes) > 1}


@pytest.fixture(scope="module", params=PACKAGES)
def package(request):
    return request.param


@pytest.fixture(scope="module")
def files(package):
    return modules(PACKAGES[package])


@pytest.fixture
def made_up(tmp_path):
    """A package with one fault of each kind, and its layers."""
    sources = {
        "low/a.py": "def later():\n    from ..high import c\n",
        "low/b.py": "from . import d\nfrom ..low.d import D\n",
        "low/d.py": "import odd.low.b\nclass D: ...\nclass _Own: ...\n",
        "high/__init__.py": "",
        "high/c.py": "from odd.low import a\nclass D: ...\nclass _Own: ...\nRows = list[int]\n",
        **{f"many/m{number}.py": "Rows = int | str\nLIMIT = 1 | 2\n" for number in range(WIDEST + 1)},
    }
    for name, source in sources.items():
        (tmp_path / "odd" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "odd" / name).write_text(source)
    return modules(tmp_path / "odd"), {"odd.low": 0, "odd.high": 1, "odd.many": 2}


def test_every_folder_has_its_layer(package, files):
    assert {folder(name, files) for name in files} == set(layers(package))


def test_imports_lead_downward(package, files):
    assert not upward(files, layers(package))


def test_no_modules_need_each_other(files):
    assert not circles(module_graph(files))


def test_no_folder_is_too_wide_to_read(files):
    assert not wide(files)


def test_a_public_class_name_means_one_class():
    every = {name: path for root in PACKAGES.values() for name, path in modules(root).items()}
    assert not twice(class_names(every))


def test_the_checks_can_fail(made_up):
    files, level = made_up
    assert upward(files, level) == {("odd.low.a", "odd.high.c")}
    assert circles(module_graph(files)) == [{"odd.high.c", "odd.low.a"}, {"odd.low.b", "odd.low.d"}]
    assert wide(files) == {"odd.many": WIDEST + 1}
    assert set(twice(class_names(files))) == {"D", "Rows"}
