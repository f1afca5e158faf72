# SPDX-License-Identifier: Apache-2.0
"""A prompt as its reader takes it: numbers and keys as sentences say them, without what is to stay as it is."""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from .lexicon.entries import normalize
from .lexicon.languages import any_of, singular, thing_words
from .lexicon.vocabulary import Vocabulary, hour_entry, kelvin_entry
from .linking import without_links
from .names import parts, scene_names
from .scene import REGIONS, SceneIndex, fit_rank, materials_of
from .types import GLOW, SaidLink, SceneDescription

_CLOCK = re.compile(r"\b(at )?(\d{1,2})(?:[:.]([0-5]\d))? ?([ap]\.?m\b\.?|o'clock)?(?![\w:])", re.IGNORECASE)
_KELVINS = re.compile(r"\b(\d{1,2}[.,' ]?\d{3}|\d{3,5})[\s-]*(?:k|kelvins?|degrees kelvin)\b", re.IGNORECASE)
_COLDEST, _HOTTEST = 600, 40000  # kelvins that somebody may ask for; 4K and 8K are sizes of images
_PAIR = re.compile(
    r"""["']?(\w(?:[\w -]|\.(?=\w)){0,60}?)["']?\s*[:=]\s*["']?([^:=,;.{}"'\n]{1,40}?)["']?(?=\s*(?:[,;.}]|$))"""
)
_MARK = "\ue000"  # a character that nobody types
_IS = "the {} is "
_MOST = 4  # words of a value; more are a sentence of their own
_AND = re.compile(r"\s*(?:,|\band\b|\bor\b)\s*")

KeyedSpan = tuple[str, int, int]  # name in the scene, start and end of what follows: "Cup: copper"
Protection = tuple[str, tuple[str, ...]]
"""A passage that says that something stays, "leave the cup alone", and the owners that stay; none if it names nothing."""


@dataclass(frozen=True)
class Normalized:
    """A prompt in the words that its reader knows; `text` is without the passages of `protections` and `links`."""

    text: str
    keyed: list[KeyedSpan]
    protections: list[Protection]
    links: list[SaidLink]
    notes: list[str]  # on links that name nothing


def normalized(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> Normalized:
    """A prompt in English, normalized."""
    own = {name.lower(): name for name in (*scene.lights, *scene.materials, *scene.object_materials)}
    text = _KELVINS.sub(_kelvins, _CLOCK.sub(_hour, text.replace("’", "'")))
    text, links, notes = without_links(text, scene, vocabulary)
    text, protections = _without_protections(_spoken(text, scene, own, vocabulary), scene, vocabulary)
    said, spans = "", []
    for number, part in enumerate(text.split(_MARK)):  # every other part is after a key
        if number % 2:
            key = max((key for key in own if said.endswith(_IS.format(key))), key=len)
            spans.append((own[key], len(said), len(said) + len(part)))
        said += part
    return Normalized(said, spans, protections, links, notes)


def _hour(match: re.Match[str]) -> str:
    """ "3 am" as "night", "at 17:30" as "at golden hour"."""
    at, hour, minutes, half = match[1] or "", int(match[2]), match[3], (match[4] or "").lower()
    if hour > 24 or not (half or (at and minutes)):
        return match[0]
    if half[:1] in ("a", "p"):
        hour = hour % 12 + 12 * (half[0] == "p")
    return at + hour_entry(hour % 24)


def _kelvins(match: re.Match[str]) -> str:
    """ "3,200K" as "3200 kelvin", the name of an entry."""
    kelvins = int(re.sub(r"\D", "", match[1]))
    return kelvin_entry(kelvins) if _COLDEST <= kelvins <= _HOTTEST else match[0]


def _spoken(text: str, scene: SceneDescription, own: dict[str, str], vocabulary: Vocabulary) -> str:
    """ "fog: none, background: white" -> "no fog, white background"; values of own names are between marks."""
    names = scene_names(scene)

    def sentence(pair: re.Match[str]) -> str:
        key, value = pair[1].strip().lower(), pair[2].strip()
        if value.lower() in vocabulary.words["off"]:
            return f"no {key}"
        if key in own:
            return f"{_IS.format(key)}{_MARK}{value}{_MARK}"
        if key in names or singular(key) in thing_words().rows:
            return f"the {key} is {value}"
        short = len(value.split()) <= _MOST
        return f"{value} {key}" if short and key in vocabulary.nouns else pair[0]

    return _PAIR.sub(sentence, text)


# Protections


def _without_protections(
    text: str, scene: SceneDescription, vocabulary: Vocabulary
) -> tuple[str, list[Protection]]:
    """A prompt without the passages that say that something stays, and these."""
    found, rest = list[Protection](), text
    for number, pattern in enumerate(vocabulary.made(_protecting)):
        for match in pattern.finditer(text):
            kept = tuple(dict.fromkeys(_kept(match["what"], scene, vocabulary)))
            if kept or number == 0:  # "keep it warm", "the light stays soft" protect nothing
                found.append((match[0].strip(), kept))
                rest = rest.replace(match[0].strip(), ",")
    return (rest if rest.strip(" ,.;") else text), found


def _protecting(v: Vocabulary) -> list[re.Pattern[str]]:
    """The ways to say that something stays; the first one says so whatever it names."""
    words = {kind: any_of(v.words[kind]) for kind in ("leave", "alone", "forbid", "keep", "stays", "stay")}
    end = r"(?=\s*(?:[,.;:!]|and\b|but\b|while\b|$))"
    one = rf"{any_of(v.lists['definite'])} [\w-]+(?: [\w-]+)?"
    thing = rf"(?:{one}|[\w-]+(?: [\w-]+)?)"
    alone = rf"(?: {words['alone']}| put)?{end}"
    texts = (
        rf"\b{words['leave']}\b(?P<what>[^,.;:]*?)\b{words['alone']}\b",
        rf"\b{words['forbid']} (?P<what>[^,.;:]+?){end}",
        rf"\b{words['keep']} (?P<what>{one}){end}",
        rf"\b(?P<what>{thing}(?:(?:,| and) {thing})+) {words['stay']}{alone}",
        rf"\b(?P<what>{one}) {words['stays']}{alone}",
    )
    return [re.compile(text, re.IGNORECASE) for text in texts]


def _kept(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> Iterator[str]:
    """The owners of parameters that nouns name: "material/Plaster", "light/Key", "world"."""
    index, groups = scene.made(SceneIndex, vocabulary), {"things": "material", "lights": "light"}
    fillers = vocabulary.lists["stop"] | vocabulary.lists["definite"]
    for phrase in _AND.split(normalize(text)):
        noun = " ".join(w for w in phrase.split() if w not in fillers)
        named = index.named(parts(noun)) if parts(noun) else []
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
