# SPDX-License-Identifier: Apache-2.0
"""The imports of a package, read from its source: who needs whom, in modules and in folders."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping
from pathlib import Path

Graph = Mapping[str, Iterable[str]]
COPIED = "vibe_render.schema"  # the engine's schema in a built extension; a clone has it in the engine


def modules(package: Path) -> dict[str, Path]:
    """Every module of a package by its dotted name; a package's own name stands for its `__init__`."""
    files = [path for path in package.rglob("*.py") if "__pycache__" not in path.parts]
    assert files, package
    return {".".join(_parts(path, package.parent)): path for path in files}


def _parts(path: Path, root: Path) -> tuple[str, ...]:
    parts = path.relative_to(root).with_suffix("").parts
    return parts[:-1] if parts[-1] == "__init__" else parts


def folder(name: str, files: Mapping[str, Path]) -> str:
    """The package that a module lies in; a package's `__init__` lies in itself."""
    return name if files[name].name == "__init__.py" else name.rpartition(".")[0]


def imported(path: Path, name: str = "") -> set[str]:
    """Dotted names that a file imports anywhere in it, also inside functions; `from a import b` gives `a.b`.

    Args:
        path: The file.
        name: The module's own dotted name, to resolve relative imports; without it they are given as ".".
    """
    package = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
    targets: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            targets |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level and not name:
            targets.add(".")
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            source = ".".join([*above, *([node.module] if node.module else [])])
            targets |= {f"{source}.{alias.name}" for alias in node.names}
    return targets


def module_graph(files: Mapping[str, Path]) -> dict[str, set[str]]:
    """Module to the modules of the same package that it imports."""

    def resolve(target: str) -> str | None:
        if target in files or target.startswith(COPIED):
            return target if target in files else None
        source = target.rpartition(".")[0]
        return source if source in files else None

    return {
        name: {t for target in imported(path, name) if (t := resolve(target)) and t != name}
        for name, path in files.items()
    }


def circles(graph: Graph) -> list[set[str]]:
    """Groups of nodes that reach each other."""
    below = {node: _reachable(graph, node) for node in graph}
    groups = {frozenset({node, *(n for n in below[node] if node in below.get(n, ()))}) for node in graph}
    return sorted((set(group) for group in groups if len(group) > 1), key=sorted)


def _reachable(graph: Graph, start: str) -> set[str]:
    reached: set[str] = set()
    waiting = [*graph[start]]
    while waiting:
        node = waiting.pop()
        if node not in reached:
            reached.add(node)
            waiting += graph.get(node, ())
    return reached
