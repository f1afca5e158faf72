# SPDX-License-Identifier: Apache-2.0
"""What of a package can be reached from its entry points: modules by imports, data by the modules that name it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Mapping
from fnmatch import fnmatchcase
from pathlib import Path

from imports import imported, modules

READ_BY_TOOLS = ("py.typed", "blender_manifest.toml", "open_clip_model.safetensors")
"""Names of files that type checkers, Blender and open_clip look for."""
_DOTTED = re.compile(r"\w+(?:\.\w+)+")


def unreachable(folder: Path, packages: Iterable[str], entries: Iterable[str]) -> set[str]:
    """Files in packages that nothing can reach.

    Args:
        folder: Where the packages are.
        packages: Their names; all files of them are looked at.
        entries: Modules that are started from outside.

    Returns:
        Paths relative to the folder.
    """
    files = {name: path for package in packages for name, path in modules(folder / package).items()}
    texts = {name: literals(path) for name, path in files.items()}
    reached = _reached(files, texts, entries)
    kept = {files[name] for name in reached}
    strange = {path for name, path in files.items() if name not in reached}
    named = {files[name]: texts[name] for name in reached}
    for package in packages:
        for path in (folder / package).rglob("*"):
            if path.is_file() and path not in kept and not _is_named(path, named):
                strange.add(path)
    return {path.relative_to(folder).as_posix() for path in strange}


def literals(path: Path) -> set[str]:
    """The strings in a module's code, with * for what a formatted one fills in; no docstrings."""
    tree, found = ast.parse(path.read_text(encoding="utf-8")), set()
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            found.add("".join(p.value if isinstance(p, ast.Constant) else "*" for p in node.values))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told:
            found.add(node.value)
    return found


def _reached(files: Mapping[str, Path], texts: Mapping[str, set[str]], entries: Iterable[str]) -> set[str]:
    """Modules that others import, also by name in a string, and the packages that they are in."""
    reached: set[str] = set()
    waiting = list(entries)
    while waiting:
        name = waiting.pop()
        while name and name not in files:
            name = name.rpartition(".")[0]
        if not name or name in reached:
            continue
        reached.add(name)
        waiting += [name.rpartition(".")[0], *imported(files[name], name)]
        waiting += [text for text in texts[name] if _DOTTED.fullmatch(text) and text in files]
    return reached


def _is_named(path: Path, named: Mapping[Path, set[str]]) -> bool:
    """Whether a module names a file, or one near it a pattern that it fits, or its folder and kind."""
    if path.name in READ_BY_TOOLS:
        return True
    for module, texts in named.items():
        if any(text.rpartition("/")[2] == path.name for text in texts):
            return True
        if module.parent not in (path.parent, path.parent.parent) and path.parent.name not in texts:
            continue
        patterns = [text.rpartition("/")[2] for text in texts if "*" in text and "." in text]
        if any(len(p.strip("*")) > 1 and fnmatchcase(path.name, p) for p in patterns):
            return True
        if module.parent == path.parent.parent and path.parent.name in texts:
            near = (t for m, t in named.items() if m.parent == module.parent)
            if any(path.suffix in texts for texts in near):
                return True
    return False
