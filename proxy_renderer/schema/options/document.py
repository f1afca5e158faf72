# SPDX-License-Identifier: Apache-2.0
"""The table of options for the documents: `python -m proxy_renderer.schema.options.document` prints it."""

from __future__ import annotations

from collections.abc import Iterable

from .option import HEADINGS, Option
from .table import TABLE


def markdown(table: Iterable[Option] = TABLE) -> str:
    """A Markdown table: each option's name, meaning, bounds, and title in Blender."""
    lines = ["| option | meaning | bounds | in Blender |", "|---|---|---|---|"]
    for option in sorted(table, key=lambda option: list(HEADINGS).index(option.heading)):
        bounds = f"{option.bounds[0]} to {option.bounds[1]}" if option.bounds else ""
        title = option.panel.title if option.panel else ""
        cells = [f"`{_usage(option)}`", option.text(option.command_default), bounds, title]
        lines.append("| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |")
    return "\n".join(lines)


def _usage(option: Option) -> str:
    if isinstance(option.default, bool):
        return option.flag
    values = f"{{{','.join(option.choices)}}}" if option.choices else option.unit
    return f"{option.flag} {values}"


if __name__ == "__main__":
    print(markdown())
