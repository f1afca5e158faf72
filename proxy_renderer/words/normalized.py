# SPDX-License-Identifier: Apache-2.0
"""Rewrites a prompt in words that the reader knows: hours, kelvins, and pairs such as "fog: none".

Takes out passages on what is to stay, and passages that link lights to objects.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ..schema.targets import NUMBER
from .attributes import fixture
from .lexicon.entries import normalize
from .lexicon.languages import any_of, singular, thing_words
from .lexicon.rigs import rig_table
from .lexicon.vocabulary import Vocabulary, hour_entry, kelvin_entry
from .names import parts, scene_names
from .passage import LIGHTS, passage
from .scene import REGIONS, LookIndex, SceneIndex, fit_rank, materials_of
from .targets import sense_at
from .types import GLOW, SaidLink, SceneDescription

_CLOCK = re.compile(r"\b(at )?(\d{1,2})(?:[:.]([0-5]\d))? ?([ap]\.?m\b\.?|o'clock)?(?![\w:])", re.IGNORECASE)
_KELVINS = re.compile(r"\b(\d{1,2}[.,' ]?\d{3}|\d{3,5})[\s-]*(?:k|kelvins?|degrees kelvin)\b", re.IGNORECASE)
_COLDEST, _HOTTEST = 600, 40000  # kelvins that somebody may ask for; 4K and 8K are sizes of images
_PAIR = re.compile(
    r"""["']?(\w(?:[\w -]|\.(?=\w)){0,60}?)["']?\s*[:=]\s*["']?([^:=,;.{}"'\n]{1,40}?)["']?(?=\s*(?:[,;.}]|$))"""
)
_MOST_WORDS = 4  # words of a value; more are a sentence of their own
_AND = re.compile(r"\s*(?:,|\band\b|\bor\b)\s*")
_JOINER = re.compile(r"(\s*\b(?:and|or|nor)\b\s*)")
_CLAUSE = re.compile(r"[,.;:!]|\b(?:and|but|with|while)\b")
_TWO_SIDES = re.compile(r"\b(?:from|on|at) one side\b(.*?)\b(?:from|on|at) the other\b(?: side| one)?", re.IGNORECASE)
_LAMPLIGHT = "lamplight"  # the rig of a room that one of its lamps lights
_MOST_OF_A_LIGHT = 3  # words of a light's name

Protection = tuple[str, tuple[str, ...]]
"""A passage such as "leave the cup alone", and the owners of parameters that stay; () if it names none in the scene."""


@dataclass(frozen=True)
class Normalized:
    """A prompt in the words that its reader knows; `text` is without the passages of `protections` and `links`."""

    text: str
    protections: list[Protection]
    links: list[SaidLink]
    notes: list[str]  # on links that name nothing
    targets: dict[str, str]  # key of a look word, "copper#1" -> name in the scene before its colon: "Cup: copper"


def normalized(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> Normalized:
    """An English prompt, rewritten in words that the reader knows."""
    own = {name.lower(): name for name in (*scene.lights, *scene.materials, *scene.objects)}
    names, targets = scene_names(scene) | {*own}, dict[str, str]()

    def sentence(pair: re.Match[str]) -> str:
        """The wording of a pair: "no fog" for "fog: none", "the cup is copper" for "cup: copper"."""
        key, value = pair[1].strip().lower(), pair[2].strip()
        if value.lower() in vocabulary.words["off"]:
            return f"no {key}"
        if key in own:
            kind = "lights" if own[key] in scene.lights else "things"
            before = [look.text for look in passage(pair.string[: pair.start()], scene, vocabulary).looks]
            for look in passage(value, scene, vocabulary).looks:
                before.append(look.text)
                if sense_at(look.token, kind, vocabulary):
                    targets[f"{look.text}{NUMBER}{before.count(look.text)}"] = own[key]
        if key in names or singular(key) in thing_words():
            return f"the {key} is {value}"
        short = len(value.split()) <= _MOST_WORDS
        return f"{value} {key}" if short and key in vocabulary.nouns else pair[0]

    text = _TWO_SIDES.sub(r"from the left\1from the right", text)
    for alone in vocabulary.made(_sole_lights):
        text = alone.sub(_sole_light, text)
    text = _KELVINS.sub(_kelvins, _CLOCK.sub(_hour, _PAIR.sub(sentence, text.replace("’", "'"))))
    text, links, notes = _without_links(text, scene, vocabulary)
    found, rest = list[Protection](), text
    for number, pattern in enumerate(vocabulary.made(_protecting)):
        for match in pattern.finditer(text):
            kept = tuple(dict.fromkeys(_kept(match["what"], scene, vocabulary)))
            if kept or number == 0:  # "keep it warm", "the light stays soft" protect nothing
                found.append((match[0].strip(), kept))
                rest = rest.replace(match[0].strip(), ",")
    return Normalized(rest if rest.strip(" ,.;") else text, found, links, notes, targets)


def _sole_lights(v: Vocabulary) -> list[re.Pattern[str]]:
    """Patterns of wordings for one light that is on alone, with the group `light`: "only the floor lamp on"."""
    rows = ("sole", "alight", "lit_by", "every_light", "put_out", "excepted")
    sole, alight, lit_by, every, out, excepted = (any_of(v.words[row]) for row in rows)
    article, end = rf"(?:{any_of(v.lists['definite'])} |an? )?", r"(?=\s*(?:[,;.]|$))"
    light, be = rf"{article}(?P<light>(?:[\w'-]+ ){{0,3}}?[\w'-]+)", r"(?:is |are )?"
    texts = (
        rf"\b{sole} {light} {be}{alight}\b",
        rf"\b{every} {be}{out},? {excepted} {light}{end}",
        rf"\b{lit_by} {light}{end}",
    )
    return [re.compile(text, re.IGNORECASE) for text in texts]


def _sole_light(match: re.Match[str]) -> str:
    """The wording of a match: "by lamplight" for a lamp of the room, "key on, everything else dark" for others."""
    light, rigs = match["light"], rig_table().rigs
    noun = singular(light.split()[-1].lower())
    if noun in rigs[_LAMPLIGHT].lights[0].names:
        return f"by {next((name for name in rigs if name.startswith(noun)), _LAMPLIGHT)}"
    return f"{light} on, everything else dark"


def _hour(match: re.Match[str]) -> str:
    """The wording of a clock time: "night" for "3 am", "at golden hour" for "at 17:30"; other numbers stay."""
    at, hour, minutes, half = match[1] or "", int(match[2]), match[3], (match[4] or "").lower()
    if hour > 24 or not (half or (at and minutes)):
        return match[0]
    if half[:1] in ("a", "p"):
        hour = hour % 12 + 12 * (half[0] == "p")
    return at + hour_entry(hour % 24)


def _kelvins(match: re.Match[str]) -> str:
    """The entry of a color temperature: "3200 kelvin" for "3,200K"; other numbers, such as "8K", stay."""
    kelvins = int(re.sub(r"\D", "", match[1]))
    return kelvin_entry(kelvins) if _COLDEST <= kelvins <= _HOTTEST else match[0]


def _protecting(v: Vocabulary) -> list[re.Pattern[str]]:
    """Patterns of wordings that the group `what` stays; the first one counts even if `what` is not in the scene."""
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
    """Yields the owners of parameters that the nouns in a text name: "material/Plaster", "light/Key", "world"."""
    index, groups = scene.made(SceneIndex, vocabulary), {"things": "material", "lights": "light"}
    for noun in (_bare(phrase, vocabulary) for phrase in _AND.split(text)):
        named = index.named(parts(noun)) if parts(noun) else []
        surest = min(map(fit_rank, named), default=None)
        names = [(n.kind, name) for n in named if fit_rank(n) == surest for name in sorted(n.names)]
        if names:
            yield from (n if k == "lights" and n.startswith(GLOW) else f"{groups[k]}/{n}" for k, n in names)
            continue
        # A general noun: the background is what lies around, and the world; the fill is a light's role
        kind = vocabulary.nouns.get(noun, "")
        role = vocabulary.role(noun)
        yield from (f"material/{name}" for name in sorted(materials_of(REGIONS.get(kind, ""), scene)))
        yield from (f"light/{name}" for name, light in scene.lights.items() if role and light.role == role)
        yield from ["world"] if kind in ("surroundings", "sky") else []


def _bare(noun: str, vocabulary: Vocabulary) -> str:
    fillers = vocabulary.lists["stop"] | vocabulary.lists["definite"]
    return " ".join(word for word in normalize(noun).split() if word not in fillers)


# Words that link lights to objects: "a rim light only on the bottle", "the lamp does not light the wall"


def _without_links(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> tuple[str, list[SaidLink], list[str]]:
    """A prompt without the words that link lights, the links, and notes on links that name nothing in the scene."""
    links, notes = list[SaidLink](), list[str]()
    *_, spares = patterns = vocabulary.made(_linking)
    for pattern in patterns:
        for match in reversed([*pattern.finditer(text)]):
            start = max((m.end() for m in _CLAUSE.finditer(text, 0, match.start())), default=0)
            said = text[start : match.start()]
            noun = _light_noun(said, scene, vocabulary)
            if not noun:
                continue
            objects, end = _objects(match, scene, vocabulary)
            lights, role = _lights(noun, scene, vocabulary)
            quote = " ".join(text[start:end].split())
            if not (lights or role):
                if pattern is not spares:  # the scene may get such a light: a spotlight
                    continue
                notes.append(f"'{quote}': there is no light '{noun}' in the scene; not used.")
            elif not objects:
                notes.append(f"'{quote}': there is no object '{match['what'].strip()}' in the scene; not used.")
            else:
                links.append(SaidLink(quote, pattern is not spares, objects, role, lights))
            bare = normalize(said).split()[: -len(noun.split())] in ([], ["the"])
            known = bare and (lights or not role)  # then these words ask for no light
            text = text[: start if known else match.start()].rstrip() + " , " + text[end:]
    return text, links[::-1], notes


def _linking(vocabulary: Vocabulary) -> list[re.Pattern[str]]:
    """Patterns of words that say what a light lights: only some objects, or by the last pattern, not some objects."""
    lights_only, only, spares = (any_of(vocabulary.words[row]) for row in ("lights_only", "only", "spares"))
    what, end = "(?P<what>[^,.;:!]+?)", r"(?=\s*(?:[,.;:!]|but\b|while\b|with\b|$))"
    texts = (rf"\b{lights_only} {what}{end}", rf"\bon {what} {only}{end}", rf"\b{spares} {what}{end}")
    return [re.compile(text, re.IGNORECASE) for text in texts]


def _light_noun(said: str, scene: SceneDescription, vocabulary: Vocabulary) -> str:
    """The noun for a light that ends the words `said`; "" if they name no particular light: "warm light"."""
    words = normalize(said).split()
    ends = [" ".join(words[-n:]) for n in range(min(_MOST_OF_A_LIGHT, len(words)), 0, -1)]
    found = next((noun for noun in ends if any(_lights(noun, scene, vocabulary))), "")
    told = (noun for noun in ends[-1:] if vocabulary.nouns.get(noun) in LIGHTS and fixture(noun, vocabulary))
    return found or next(told, "")


def _lights(noun: str, scene: SceneDescription, vocabulary: Vocabulary) -> tuple[tuple[str, ...], str]:
    """The lights of the scene that a noun names, and the role of lights that it stands for; () and "" for none."""
    alone = " ".join(word for word in noun.split() if word not in vocabulary.lists["anylight"])
    index = scene.made(SceneIndex, vocabulary)
    named = (n for said in dict.fromkeys((noun, alone)) if parts(said) for n in index.named(parts(said)))
    own = (n for n in named if n.kind == "lights" and any(sign.startswith("light ") for sign in n.signs))
    names = {name: None for n in own for name in sorted(n.names) if not name.startswith(GLOW)}
    kind = vocabulary.nouns.get(noun, "")
    role = kind if kind in ("fill", "rim") else vocabulary.role(noun)
    return tuple(names), role if kind in LIGHTS and fixture(noun, vocabulary) else ""


def _objects(match: re.Match[str], scene: SceneDescription, vocabulary: Vocabulary) -> tuple[tuple[str, ...], int]:
    """The objects that the nouns of a link name, and where in the text the link ends: before "and warm fog"."""
    first, *others = _JOINER.split(match["what"])
    found, end = [*_called(first, scene, vocabulary)], match.start("what") + len(first)
    for joiner, noun in zip(others[::2], others[1::2], strict=True):
        named = _called(noun, scene, vocabulary)
        if not named:
            return tuple(found), end
        found, end = [*dict.fromkeys([*found, *named])], end + len(joiner) + len(noun)
    return tuple(found), match.end()


def _called(noun: str, scene: SceneDescription, vocabulary: Vocabulary) -> tuple[str, ...]:
    """The objects that a noun names: by their names, by the shape of their materials, or as subject or surroundings."""
    noun = _bare(noun, vocabulary)
    if not noun:
        return ()
    index = scene.made(SceneIndex, vocabulary)
    if whole := index.objects(parts(noun)):
        return tuple(dict.fromkeys(each for name in whole for each in (name, *index.parts_of(name))))
    materials = scene.made(LookIndex, vocabulary).shaped(noun)
    region = REGIONS.get(vocabulary.nouns.get(noun, ""), "")
    return tuple(
        name
        for name, its in scene.objects.items()
        if not materials.isdisjoint(scene.object_materials.get(name, ())) or (its == region and not materials)
    )
