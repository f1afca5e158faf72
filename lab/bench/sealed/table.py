# SPDX-License-Identifier: Apache-2.0
"""The figures of a sealed set: asks held of those asked, by kind, with intervals."""

from __future__ import annotations

import statistics
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table

from lab.bench.paper.verdict import wilson

JobResult = Mapping[str, Any]


def summary(rows: Sequence[JobResult]) -> dict[str, Any]:
    """The content of results.json.

    Returns:
        `asks`: all asks, `asks_seen`: those of pictures whose subject can be seen held, all others not, and `kinds`: by kind,
        each with `held`, `asked`, `share` and its 95 % `interval`; `new_colors`: colors whose names the product's lexicon
        does not list; `prompts`: those whose every ask holds; `claims`:
        the product's own; `unjudged`: asks of things that are hardly in view; `words_ignored`; `seconds`, the median;
        `failed`: prompts without a picture; `rows`. The asks of failed prompts count as asked and not held.
    """
    done = [row for row in rows if row["code"] == 0]
    asks = [(row, ask) for row in done for ask in row["asks"] if ask["holds"] is not None]
    lost = sum(row["asked"] for row in rows if row["code"] != 0)
    kinds = dict.fromkeys(ask["kind"] for _, ask in asks)
    judged = [[ask["holds"] for ask in row["asks"] if ask["holds"] is not None] for row in done]
    return {
        "asks": share([ask["holds"] for _, ask in asks] + [False] * lost),
        "asks_seen": share([ask["holds"] and row["seen"] for row, ask in asks] + [False] * lost),
        "kinds": {kind: share([a["holds"] for _, a in asks if a["kind"] == kind]) for kind in sorted(kinds)},
        "new_colors": share([ask["holds"] for _, ask in asks if ask["new_color"]]),
        "prompts": share([all(held) for held in judged if held] + [False] * (len(rows) - len(done))),
        "claims": claims_of(rows),
        "unjudged": sum(ask["holds"] is None for row in done for ask in row["asks"]),
        "words_ignored": sum(len(row["ignored"]) for row in done),
        "seconds": round(statistics.median(row["seconds"] for row in rows), 1) if rows else None,
        "failed": {row["prompt"]: row["error"] for row in rows if row["code"] != 0},
        "rows": list(rows),
    }


def share(held: Iterable[bool]) -> dict[str, Any]:
    """Number of them that hold, with the 95 % interval of the share."""
    kept = list(held)
    return _share(sum(kept), len(kept))


def claims_of(rows: Iterable[JobResult]) -> dict[str, Any]:
    """Number of the product's own claims that hold in the pictures that there are, likewise."""
    done = [row for row in rows if row["code"] == 0]
    return _share(sum(row["claims_held"] for row in done), sum(row["claims"] for row in done))


def _share(held: int, asked: int) -> dict[str, Any]:
    low, high = wilson(held, asked)
    return {
        "held": held,
        "asked": asked,
        "share": round(held / asked, 4) if asked else None,
        "interval": [round(low, 4), round(high, 4)],
    }


def line(row: JobResult) -> str:
    """One job in a line."""
    if row["code"] != 0:
        return f"FAILED: {row['error']}"
    unseen = "" if row["seen"] else ", the subject is hardly seen"
    return f"{', '.join(map(ticked, row['asks']))}{unseen} ({row['seconds']:.0f} s)"


def ticked(ask: Mapping[str, Any]) -> str:
    """An ask with its verdict, and why not."""
    mark = {True: "+", False: "-", None: "?"}[ask["holds"]]
    why = "; ".join(f"{r['says']} {r['amount']}, {r['wanted']}" for r in ask["found"] if not r["holds"])
    return f"{mark}{ask['words']}" + (f" [{why}]" if why else "")


def show(results: Mapping[str, Any]) -> None:
    """Prints the table, and which words were ignored."""
    table = Table("asks", "held", "asked", "share", "95 % interval", box=None, pad_edge=False)
    for column in table.columns[1:]:
        column.justify = "right"
    parts = {"all": results["asks"], "and the subject is seen": results["asks_seen"], **results["kinds"]}
    parts["color, of a name that is not in the lexicon"] = results["new_colors"]
    parts |= {"prompts, every ask": results["prompts"], "the product's own claims": results["claims"]}
    for name, each in parts.items():
        low, high = each["interval"]
        shown = "" if each["share"] is None else f"{each['share']:.0%}"
        table.add_row(name, str(each["held"]), str(each["asked"]), shown, f"{low:.0%} to {high:.0%}")
    console = Console(width=None if Console().is_terminal else 120)
    console.print(table)
    ignored = [word for row in results["rows"] for word in row.get("ignored", ())]
    closing = f"Words ignored: {len(ignored)}{': ' + ', '.join(ignored) if ignored else ''}. "
    closing += f"Asks of what is hardly in view, left out: {results['unjudged']}. "
    closing += f"A prompt took {results['seconds']} s (median)."
    console.print(closing, markup=False, highlight=False)
