# SPDX-License-Identifier: Apache-2.0
"""A prompt as its reader takes it: hours, temperatures and keys as sentences say them, without what is to stay as it is."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from .lexicon.entries import normalize
from .lexicon.languages import any_of
from .lexicon.vocabulary import Vocabulary, kelvin_entry
from .names import parts, scene_names
from .scene import REGIONS, SceneIndex, fit_rank, materials_of
from .types import GLOW, SceneDescription

_HALF, _DAY = 12, 24  # hours
_BESIDE = re.compile(r"\b(before|after) (?:the )?(\w+(?: \w+)?)", re.IGNORECASE)
_KELVINS = re.compile(r"\b(\d{1,2}[.,' ]?\d{3}|\d{3,5})[\s-]*(?:k|kelvins?|degrees kelvin)\b", re.IGNORECASE)
_COLDEST, _HOTTEST = 600, 40000  # kelvins that somebody may ask for; 4K and 8K are sizes of images
_PAIR = re.compile(
    r"""["']?(\w(?:[\w -]|\.(?=\w)){0,60}?)["']?\s*[:=]\s*["']?([^:=,;.{}"'\n]{1,40}?)["']?(?=\s*(?:[,;.}]|$))"""
)
_MARK = "\ue000"  # a character that nobody types
_IS = "the {} is "
_MOST = 4  # words of a value; more are a sentence of their own
_END = r"(?=\s*(?:[,.;:!]|and\b|but\b|while\b|$))"
_AND = re.compile(r"\s*(?:,|\band\b|\bor\b)\s*")


KeyedSpan = tuple[str, int, int]
"""Name in the scene, and start and end of the passage after it and a colon: "Cup: copper"."""
Protection = tuple[str, tuple[str, ...]]
"""A passage that says that something stays, "leave the cup alone", and the owners that stay; none if it names nothing."""


@dataclass(frozen=True)
class Normalized:
    """A prompt in the words that its reader knows; `text` is without the passages of `protections`."""

    text: str
    keyed: list[KeyedSpan]
    protections: list[Protection]


def normalized(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> Normalized:
    """A prompt in English, normalized."""
    own = scene.made(_own_names, vocabulary)
    text = _KELVINS.sub(_kelvins, _with_hours(text, vocabulary))
    text, protections = _without_protections(_spoken(text, scene, own, vocabulary), scene, vocabulary)
    said, spans = "", []
    for number, part in enumerate(text.split(_MARK)):  # every other part is after a key
        key = max((key for key in own if said.endswith(_IS.format(key))), key=len, default="")
        if number % 2 and key:
            spans.append((own[key], len(said), len(said) + len(part)))
        said += part
    return Normalized(said, spans, protections)


def _own_names(scene: SceneDescription, _: Vocabulary) -> dict[str, str]:
    """The names of a scene's objects, materials and lights, by how they are in lower case."""
    return {name.lower(): name for name in (*scene.lights, *scene.materials, *scene.object_materials)}


# Hours (hours.toml)


@cache
def _hours() -> dict[str, Any]:
    """hours.toml, each of its texts as a list of words."""

    def listed(row: Any) -> Any:
        if isinstance(row, dict):
            return {name: listed(part) for name, part in row.items()}
        return [word.strip() for word in row.split(",")]

    path = Path(__file__).with_name("lexicon") / "hours.toml"
    rows: dict[str, Any] = listed(tomllib.loads(path.read_text("utf-8")))
    return rows


@cache
def _hour_patterns() -> list[re.Pattern[str]]:
    """Times by the clock, times by the sun, and words that change nothing of where light comes from."""
    rows, sun = _hours()["clock"], _hours()["sun"]
    halves = any_of([*rows["first"], *rows["second"], *rows["night"]])
    does = any_of([phrase for name, phrases in sun.items() if name != "between" for phrase in phrases])
    clock = (
        rf"\b(?P<at>at )?(?:{any_of(rows['minutes'])} )?(?P<hour>{any_of(rows['numbers'])}|\d{{1,2}})"
        rf"(?P<minutes>(?<=\d):\d\d(?! ?:))?(?: ?(?P<exact>{any_of(rows['exact'])}))?(?: ?(?P<half>{halves}))?(?!\w)"
    )
    by_sun = rf"\b(?:the )?sun(?:'s)? (?:(?:{any_of(sun['between'])}) )*?(?P<does>{does})\b"
    exactly = rf"\bfrom (?:{any_of(_hours()['where']['exactly'])}) "
    return [re.compile(pattern, re.IGNORECASE) for pattern in (clock, by_sun, exactly)]


def _with_hours(text: str, vocabulary: Vocabulary) -> str:
    """A prompt with times of day as the vocabulary calls them: "three in the morning", "as the sun goes down", "after dusk"."""

    def by_clock(match: re.Match[str]) -> str:
        """ "3 am" as "night", "half past six in the evening" as "golden hour"."""
        rows, numbers = _hours()["clock"], _hours()["clock"]["numbers"]
        word, half = match["hour"].lower(), (match["half"] or "").lower()
        hour = numbers.index(word) + 1 if word in numbers else int(word)
        if hour > _DAY or not (half or match["exact"] or (match["at"] and match["minutes"])):
            return match[0]
        if half:
            at_night = half in rows["night"] and hour % _HALF >= _HALF / 2
            hour = hour % _HALF + _HALF * (half in rows["second"] or at_night)
        since = {int(start): name for start, (name,) in _hours()["from_hour"].items()}
        return f"{match['at'] or ''}{since[max(start for start in since if start <= hour % _DAY)]}"

    def by_sun(match: re.Match[str]) -> str:
        does = " ".join(match["does"].lower().split())
        return next(entry for entry, phrases in _hours()["sun"].items() if does in phrases)

    def beside(match: re.Match[str]) -> str:
        """ "After dusk" as "night"; phrases that the vocabulary has, "after dark", stay so."""
        day, side, both = _hours()["day"], match[1].lower(), match[2].lower()
        for said in (both, both.partition(" ")[0]):
            entry = vocabulary.synonyms.get(said, "")
            if f"{side} {said}" in vocabulary.synonyms:
                return match[0]
            if entry in day and entry not in _hours()["long"]:
                step = 1 if side == "after" else -1
                return str(day[(day.index(entry) + step) % len(day)]) + match[2][len(said) :]
        return match[0]

    clock, sun, exactly = _hour_patterns()
    return _BESIDE.sub(beside, exactly.sub("from ", clock.sub(by_clock, sun.sub(by_sun, text))))


def _kelvins(match: re.Match[str]) -> str:
    """ "3,200K" as "3200 kelvin", the name of an entry."""
    kelvins = int(re.sub(r"\D", "", match[1]))
    return kelvin_entry(kelvins) if _COLDEST <= kelvins <= _HOTTEST else match[0]


# Keys and lists, as programs and form fillers write them


def _spoken(text: str, scene: SceneDescription, own: dict[str, str], vocabulary: Vocabulary) -> str:
    """ "fog: none, background: white" -> "no fog, white background"; values of own names are between marks."""
    names = scene_names(scene)

    def sentence(pair: re.Match[str]) -> str:
        key, value = pair[1].strip().lower(), pair[2].strip()
        if value.lower() in vocabulary.words["off"]:
            return f"no {key}"
        if key in own:
            return f"{_IS.format(key)}{_MARK}{value}{_MARK}"
        if key in names:
            return f"the {key} is {value}"
        short = len(value.split()) <= _MOST
        return f"{value} {key}" if short and key in vocabulary.nouns else pair[0]

    return _PAIR.sub(sentence, text)


# Protections


def _without_protections(
    text: str, scene: SceneDescription, vocabulary: Vocabulary
) -> tuple[str, list[Protection]]:
    """A prompt without the passages that say that something stays, and these."""
    text, found = text.replace("’", "'"), list[Protection]()
    for number, pattern in enumerate(vocabulary.made(_protecting)):
        for match in pattern.finditer(text):
            kept = tuple(dict.fromkeys(_kept(match["what"], scene, vocabulary)))
            if kept or number == 0:  # "keep it warm", "the light stays soft" protect nothing
                found.append((match[0].strip(), kept))
    rest = text
    for passage, _ in found:
        rest = rest.replace(passage, ",")
    return (rest if rest.strip(" ,.;") else text), found


def _protecting(v: Vocabulary) -> list[re.Pattern[str]]:
    """The ways to say that something stays; the first one says so whatever it names."""
    words = {kind: any_of(v.words[kind]) for kind in ("leave", "alone", "forbid", "keep", "stays", "stay")}
    thing = rf"(?:{any_of(v.lists['definite'])} )?[\w-]+(?: [\w-]+)?"
    one = rf"{any_of(v.lists['definite'])} [\w-]+(?: [\w-]+)?"
    alone = rf"(?: {words['alone']}| put)?{_END}"
    texts = (
        rf"\b{words['leave']}\b(?P<what>[^,.;:]*?)\b{words['alone']}\b",
        rf"\b{words['forbid']} (?P<what>[^,.;:]+?){_END}",
        rf"\b{words['keep']} (?P<what>{one}){_END}",
        rf"\b(?P<what>{thing}(?:(?:,| and) {thing})+) {words['stay']}{alone}",
        rf"\b(?P<what>{one}) {words['stays']}{alone}",
    )
    return [re.compile(text, re.IGNORECASE) for text in texts]


def _kept(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> Iterator[str]:
    """The owners of parameters that nouns name: "material/Plaster", "light/Key", "world"."""
    index, groups = scene.made(SceneIndex, vocabulary), {"things": "material", "lights": "light"}
    for phrase in _AND.split(normalize(text)):
        fillers = vocabulary.lists["stop"] | vocabulary.lists["definite"]
        noun = " ".join(w for w in phrase.split() if w not in fillers)
        named = index.named(parts(noun), plural=noun.endswith("s")) if noun and parts(noun) else []
        surest = min(map(fit_rank, named), default=None)
        names = [(n.kind, name) for n in named if fit_rank(n) == surest for name in sorted(n.names)]
        if names:
            yield from (n if k == "lights" and n.startswith(GLOW) else f"{groups[k]}/{n}" for k, n in names)
            continue
        # A general noun: the background is what lies around, and the world; the fill is a light's role
        kind = vocabulary.nouns.get(noun, "")
        role = next((vocabulary.roles[word] for word in noun.split() if word in vocabulary.roles), "")
        yield from (f"material/{name}" for name in sorted(materials_of(REGIONS.get(kind, ""), scene)))
        yield from (f"light/{name}" for name, light in scene.lights.items() if role and light.role == role)
        yield from ["world"] if kind in ("surroundings", "sky") else []
