# SPDX-License-Identifier: Apache-2.0
"""report.html: every pair with its pictures, its measures and who won. It needs no other file and no network."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

from lab.bench.paper import figures
from lab.bench.paper.measures import NOTICES, SAYS, UNITS
from lab.bench.paper.pairs import COMPARED, Ask, Pair
from lab.bench.paper.runs import BASELINE, Run
from lab.bench.paper.verdict import RULE
from lab.methods import OURS
from proxy_renderer.color.floats import srgb_from_lab

_LONGEST = 420  # pixels of a picture's longer side
_TITLES = {
    "benchmark": "The paper’s benchmark",
    "wider": "The wider set",
    "concrete_vs_abstract": "Concrete against abstract words",
    "prompt_extension": "Longer and longer prompts",
}
_SAID = {"win": "ours", "tie": "tie", "loss": "CLIP-only"}


def render(results: Mapping[str, Any], planned: Sequence[Run], out: Path) -> str:
    """The page.

    Args:
        planned: All runs; those that are not done are left out.
    """
    style = (Path(__file__).parent / "page.css").read_text("utf-8")
    sections = "".join(_section(group, results, planned) for group in _TITLES)
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>Vibe Render against CLIP-only</title><style>{style}</style></head><body>"
        f"{_hero(results)}<main>{_model(results)}{sections}{_method(results)}</main></body></html>"
    )


def _hero(results: Mapping[str, Any]) -> str:
    low, high = results["interval"]
    parts = "".join(
        f'<i class="{kind}" style="flex:{results[kind]}"></i>' for kind in ("win", "tie", "loss") if results[kind]
    )
    counts = "".join(
        f'<li><b class="{kind}">{results[kind]}</b>{kind if results[kind] == 1 else many}</li>'
        for kind, many in (("win", "wins"), ("tie", "ties"), ("loss", "losses"))
    )
    return (
        "<header><p>Vibe Render</p><h1>The look follows the words.</h1>"
        f"<p>The same scenes, the same words, the same encoder, the same number of steps: structured guidance against a "
        f"similarity alone, over {results['pairs']} development pairs of a scene and a prompt.</p>"
        f'<div class="rate"><strong>{results["win_rate"]:.0%}</strong><span>of the pairs won<br>'
        f"<small>95 % interval {low:.0%} to {high:.0%}</small></span></div>"
        f'<div class="bar">{parts}</div><ul class="counts">{counts}</ul></header>'
    )


def _model(results: Mapping[str, Any]) -> str:
    """The vision-language model's word on the paper's figure; nothing without one."""
    verdict = results["judge"].get("figure", {})
    if not verdict:
        return ""
    text = f"{verdict['winner']}. {verdict['reason']}" if "winner" in verdict else verdict["error"]
    return (
        f'<section><h2>The judge</h2><p class="lead">{escape(results["judge"]["model"])}: {escape(text)}</p></section>'
    )


def _section(group: str, results: Mapping[str, Any], planned: Sequence[Run]) -> str:
    pairs = [p for p in dict.fromkeys(r.pair for r in planned) if p.group == group]
    rows = results["by_pair"] if group in COMPARED else results["ablations"]
    cards = [_card(p, rows[p.name], results, planned) for p in pairs if p.name in rows]
    return f"<section><h2>{_TITLES[group]}</h2>{''.join(cards)}</section>" if cards else ""


def _card(pair: Pair, row: Mapping[str, Any], results: Mapping[str, Any], planned: Sequence[Run]) -> str:
    """A pair: its prompt, the pictures of the first seed, the measures of all."""
    done = {r.variation: r.folder for r in planned if r.pair == pair and r.seed == 0 and r.done}
    compared = pair.group in COMPARED
    panels = [("before", done[OURS], "before"), ("ours", done[OURS], "after")] if OURS in done else []
    panels += [("CLIP-only", done[BASELINE], "after")] if BASELINE in done else []
    seeds = row["seeds"] if compared else [{"ours": row["ours"]}]
    scores = {"ours": row["ours"], "CLIP-only": row["clip_only"]} if compared else {}
    pictures = "".join(
        f'<figure><img alt="{escape(label)}" src="{_data(folder, which)}"><figcaption>{label}'
        f"{f'<b>{scores[label]:.2f}</b>' if label in scores else ''}</figcaption></figure>"
        for label, folder, which in panels
    )
    badge = f'<span class="badge {row["verdict"]}">{_SAID[row["verdict"]]}</span>' if compared else ""
    verdict = results["judge"].get("pairs", {}).get(pair.name, {}) if compared else {}
    model = (
        f'<p class="said">The model: {escape(verdict.get("winner", ""))}. {escape(verdict.get("reason", ""))}</p>'
        if "winner" in verdict
        else ""
    )
    return (
        f'<article><h3>“{escape(pair.prompt)}”{badge}</h3><div class="strip">{pictures}</div>'
        f"{_table(pair, seeds, compared)}{model}</article>"
    )


def _table(pair: Pair, seeds: Sequence[Mapping[str, Any]], compared: bool) -> str:
    sides = ("ours", "clip_only") if compared else ("ours",)
    head = "".join(f"<th>{'ours' if side == 'ours' else 'CLIP-only'}</th>" for side in sides)
    body = ""
    for ask in pair.asks:
        measure = "color" if ask.lab else ask.trait.measure
        unit = "ΔE" if ask.lab else UNITS[measure]
        cells = "".join(_cell([s[side]["asks"][ask.text] for s in seeds], unit) for side in sides)
        body += f"<tr><td>{_chip(ask)}{escape(ask.text)}<small>{measure.replace('_', ' ')}</small></td>{cells}</tr>"
    visibility = "".join(
        _cell([{"amount": s[side]["visibility"], "score": _product(s[side]["visibility"])} for s in seeds], "")
        for side in sides
    )
    return f"<table><tr><th></th>{head}</tr>{body}<tr><td>subject visible<small>outline × detail × frame</small></td>{visibility}</tr></table>"


def _chip(ask: Ask) -> str:
    """A spot of the color that is asked for."""
    if ask.lab is None:
        return ""
    red, green, blue = (round(255 * v) for v in srgb_from_lab(ask.lab))
    return f'<i class="chip" style="background:rgb({red} {green} {blue})"></i>'


def _cell(entries: Sequence[Mapping[str, Any]], unit: str) -> str:
    """The mean over the seeds, as a bar, with the measured amounts."""
    score = sum(entry["score"] for entry in entries) / len(entries)
    amounts = [entry["amount"] for entry in entries]
    if isinstance(amounts[0], Mapping):
        text = " × ".join(f"{sum(a[k] for a in amounts) / len(amounts):.2f}" for k in amounts[0])
    else:
        text = f"{sum(amounts) / len(amounts):.3g} {unit}"
    return f'<td><span class="meter"><i style="width:{score:.0%}"></i></span><small>{text}</small></td>'


def _product(parts: Mapping[str, float]) -> float:
    whole = 1.0
    for value in parts.values():
        whole *= value
    return whole


def _method(results: Mapping[str, Any]) -> str:
    budget, blind = results["budget"], results["without_visibility"]
    judged = (
        " An encoder that was never optimized is asked too, as one ask among them." if results["judge_encoder"] else ""
    )
    rows = "".join(
        f"<tr><td>{name.replace('_', ' ')}</td><td>{escape(says)}</td><td>{NOTICES[name]:g} {UNITS[name]}</td></tr>"
        for name, says in SAYS.items()
    )
    return (
        f'<section class="method"><h2>How a pair is decided</h2><p class="lead">{escape(RULE)}{judged}</p>'
        f"<table><tr><th>measure</th><th>what it is</th><th>just noticeable</th></tr>{rows}</table>"
        f"<p>By scores that leave out how well the subject can be seen: {blind['win']} won, {blind['tie']} tied, "
        f"{blind['loss']} lost.</p>"
        f"<p>{budget['rounds']} rounds of {budget['steps']} steps, {budget['size']} pixels, {budget['samples']} samples of "
        f"Cycles, {budget['seeds']} seed{'s' if budget['seeds'] > 1 else ''}. All pictures are renders of Cycles.</p></section>"
    )


def _data(folder: Path, which: str) -> str:
    """A picture within the page."""
    image = figures.picture(folder, which)
    image.thumbnail((_LONGEST, _LONGEST))
    file = io.BytesIO()
    image.save(file, "JPEG", quality=88)
    return "data:image/jpeg;base64," + base64.b64encode(file.getvalue()).decode()
