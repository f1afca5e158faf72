# SPDX-License-Identifier: Apache-2.0
"""The fields of `report.json` that the engine knows, and the verdict on every word."""

import os
import platform
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import metadata
from typing import Any

import torch

from .. import __version__
from ..claims.claim import ShotClaims
from ..claims.measures import MEASURES
from ..color.tensors import linear_from_srgb
from ..goals.written import as_json
from ..optimize.pipeline import Outcome
from ..optimize.rounds.method import VARIABLE
from ..optimize.shots import LOCKED, BlenderPictures, ShotState
from ..render.surface.view_cache import GBuffer
from ..schema import Values, labels
from ..schema.messages import word_states, words_of
from ..words.lexicon.quantities import quantities
from ..words.lexicon.vocabulary import default_vocabulary
from ..words.types import PromptWord


def search_facts(outcome: Outcome, words: Sequence[PromptWord]) -> dict[str, Any]:
    """Fields of report.json on the search: goals, parameters, rounds, versions, and the reading of the prompt."""
    goals, prompts = outcome.goals, outcome.prompts
    versions = {"vibe-render": __version__, "python": platform.python_version()}
    for package in ("torch", "open_clip_torch", "numpy", "opencolorio", "trimesh"):
        with suppress(metadata.PackageNotFoundError):
            versions[package] = metadata.version(package)
    return {
        "method": os.environ.get(VARIABLE, ""),
        "goals": as_json(goals),
        "parameters": parameter_records(outcome),
        "rounds": outcome.rounds,
        "understood": {
            "subject": prompts.subject,
            "surroundings": prompts.surroundings,
            "whole": prompts.whole,
            "classes": goals.classes,
            "ignored": goals.parsed.ignored,
            "guesses": goals.parsed.guesses,
            "words": [word.row() for word in words],
            "notes": list(dict.fromkeys([*goals.parsed.notes, *outcome.plan.notes])),
        },
        "versions": versions,
    }


def parameter_records(outcome: Outcome) -> dict[str, dict[str, Any]]:
    """Parameter -> record: "moved" is a distance on the perceptual scale; "priority" 0 comes first, None stays."""

    def plain(values: Values) -> float | list[float]:
        return values[0] if len(values) == 1 else list(values)

    after = outcome.vector.values(outcome.u)
    lower, upper = (outcome.vector.plain(b) for b in outcome.vector.bounds(outcome.ranges))
    links = outcome.shots[0].scene.links.items()
    none = {"before": 0.0, "after": 1.0, "lower": 0.0, "upper": 1.0, "moved": 1.0, "priority": None}
    return {key: {**none, "optimized": False, "reason": said} for key, said in links} | {
        key: {
            "before": plain(instance.value),
            "after": plain(after[key]),
            "lower": plain(lower[key]),
            "upper": plain(upper[key]),
            "moved": round(instance.distance(after[key]), 4),
            "priority": outcome.plan[key].priority,
            "optimized": key in outcome.optimized,
            "reason": instance.locked or outcome.plan[key].reason,
        }
        for key, instance in outcome.vector.instances.items()
    }


def changed_values(outcome: Outcome, shot: ShotState | None = None) -> dict[str, list[float]]:
    """Key -> components of each value that differs from the artist's scene; keys are those of `shot`, or the first."""
    vector = (shot or outcome).vector
    return {k: list(v) for k, v in vector.changes(outcome.u).items()}


def anchored(outcome: Outcome, blenders: Sequence[BlenderPictures]) -> dict[str, Any]:
    """{"anchored": {"pictures", "predicted", "notes"}} on the anchors, for report.json.

    "predicted" is the mean ΔE of the proxy's predictions from the last anchors; it is missing without anchors.
    """
    pictures = []
    for shot, blender in zip(outcome.shots, blenders, strict=True):
        pairs = zip(shot.records, blender.seconds, strict=True)
        pictures += [{**record, "seconds": seconds} for record, seconds in pairs]
    notes = dict.fromkeys(note for blender in blenders for note in blender.notes)
    predicted = [shot.records[-1]["delta_e"] for shot in outcome.shots if shot.records]
    mean = {"predicted": round(sum(predicted) / len(predicted), 3)} if predicted else {}
    return {"anchored": {"pictures": pictures, **mean, "notes": list(notes)}}


def claims_about(outcome: Outcome) -> list[ShotClaims]:
    """The claims about each shot, with its G-buffers at the artist's values and at the values found."""
    found = []
    for shot in outcome.shots:
        assert shot.before is not None, "the loop has begun"
        found.append(ShotClaims(outcome.claims, shot.before.seen, shot.gbuffer(outcome.u)))
    return found


def foreseen(outcome: Outcome, claims: list[ShotClaims]) -> list[dict[str, Any]]:
    """Verdicts on the first shot's claims by the proxy's prediction, which the last anchor corrects."""
    shot = outcome.shots[0]
    assert shot.before is not None, "the loop has begun"
    with torch.no_grad():
        after = shot.draw(outcome.u).display
    return claims[0].verdicts(shot.before.display, after, after)


# Verdicts on every word, and why the image does not show it


_HELPS = 1.0  # noticeable steps of a claim: a value whose whole range changes the claim by less does not help it
_LEFT = 0.5  # noticeable steps: a value is at the end of its range if the rest of the range gains less
_WORSE = 0.3  # noticeable steps: a claim conflicts if a value's step makes it worse by as much
_NOTHING = dict.fromkeys(("word", "state", "missing", "why", "unlock"), "")
_UNLIT = 0.005  # linear display value up to which a gray surface counts as reached by no light


def word_verdicts(outcome: Outcome, rows: Sequence[Mapping[str, Any]], seen: GBuffer) -> list[dict[str, str]]:
    """A row for each word, then one with the word "" for each missed rule that is meant for every image.

    `rows` are a shot's verdicts on claims; `seen` is the first shot's G-buffer at the values found. A word's "state" is
    "visible", "already" (satisfied before the search), "unmeasured" or "missed". For a missed word, "missing" compares
    its value with the wanted one, and "why" is the reason; "unlock" is the key of a value whose lock is the reason, or
    "".
    """
    goals, states, found = outcome.goals, word_states(rows), []
    vague = default_vocabulary().lists["unmeasured"]
    winners = {each.wish.attribute: each.winner.word for each in goals.lost if each.is_news}
    entries = {}
    for wish in (*(each.wish for each in goals.lost), *goals.wishes):
        entries[wish.attribute.cause or wish.word] = wish.attribute
    for word in dict.fromkeys((*states, *entries)):
        state, attribute = states.get(word, "unmeasured"), entries.get(word)
        row = {**_NOTHING, "word": word, "state": state}
        if attribute in winners and attribute in goals.overruled:
            row |= {"state": "missed", "why": f"it conflicts with '{winners[attribute]}'"}
        elif state == "missed":
            number = next(i for i, r in enumerate(rows) if word in words_of(r) and r["holds"] is False)
            row |= {"missing": _missing(rows[number])} | _obstacle(outcome, number, seen)
        elif attribute and attribute.entry in vague:
            row["state"] = "unmeasured"
        found.append(row)
    rules = [row for row in rows if not row["word"] and row["holds"] is False]
    return [*found, *({**_NOTHING, "state": "missed", "missing": _missing(row)} for row in rules)]


def _missing(row: Mapping[str, Any]) -> str:
    """Text on a missed claim, from its verdict: "color of the wall is #b09080, wanted #cceede"."""
    about = MEASURES[row["measure"]].sentence.format("image" if row["thing"] == "picture" else row["thing"])
    after = f"{row['after']:.3g}" if isinstance(row["after"], float) else row["after"]
    unit = f" {row['unit']}" if row["unit"] and not str(after).startswith("#") else ""
    return f"{about} is {after}{unit}, wanted {row['wanted']}"


def _obstacle(outcome: Outcome, number: int, seen: GBuffer) -> dict[str, str]:
    """The reason why claim `number` is missed: "why" (text), and "unlock", the key of a value that a lock keeps."""
    claim, table = outcome.claims[number], quantities()

    # All values that could serve the claim may be locked.
    rows = (f"thing {claim.measure}", f"{claim.part} {claim.measure}", claim.measure)
    quantity = next((table.measures[row] for row in rows if row in table.measures), "")
    every = outcome.vector.instances.values()
    serving = [each for each in every if table.parameters.get(each.parameter.family) == quantity]
    if claim.materials:
        serving = [each for each in serving if each.owner in claim.materials]
    if serving and all(each.locked for each in serving):
        key = serving[0].key
        why = f"{labels.title(key)} may not change: {serving[0].locked}"
        return {"why": why, "unlock": key if LOCKED in why else ""}

    where = claim.region(seen)
    lit = seen.gray is None or where is None or linear_from_srgb(seen.gray[where]).mean() > _UNLIT
    if claim.is_of_thing and not lit:
        return {"why": f"no light reaches the {claim.thing}"}
    return {"why": _opponent(outcome, number)}


def _opponent(outcome: Outcome, number: int) -> str:
    """The reason why unlocked values miss claim `number`, by the linear model of the last steps; "" without a model."""
    known = outcome.descent.known if outcome.descent else None
    regions = [where for shot in outcome.shots if shot.claims for where in enumerate(shot.claims.regions)]
    measured = [i for i, where in regions if where is not None]  # numbers of claims, shot by shot
    if known is None or number not in measured:
        return ""
    (model, places, low, high), here = known, known[0].here
    mine = here.claim == measured.index(number)
    missed = (here.values - here.values.clamp(here.lower, here.upper))[mine]
    slope = model.slopes[mine].T @ missed / missed.norm().clamp_min(1e-6)
    move = torch.where(slope > 0, low, high)
    gain, left = slope.abs(), slope.abs() * move.abs()
    if gain.max() < _HELPS:
        return "no value that may change has much effect on it"
    if left.max() < _LEFT:
        place = int(places[gain.argmax()])
        key = next(key for key, part in outcome.vector.slices.items() if part.start <= place < part.stop)
        return f"{labels.title(key)} is at the end of its range"
    step = torch.where(left == left.max(), move, 0.0)
    worse = here.misses(here.values + model.slopes @ step) - here.misses(here.values)
    worse[[i == number for i in measured]] = 0.0
    if worse.max() < _WORSE:
        return "more rounds may come nearer"
    other = outcome.claims[measured[int(worse.argmax())]]
    return f"it conflicts with '{other.word or MEASURES[other.measure].says}'"
