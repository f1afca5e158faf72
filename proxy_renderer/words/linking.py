# SPDX-License-Identifier: Apache-2.0
"""Words that link lights to objects: "a rim light only on the bottle", "the lamp does not light the wall"."""

import re

from .attributes import fixture
from .lexicon.entries import normalize
from .lexicon.languages import any_of
from .lexicon.vocabulary import Vocabulary
from .names import parts
from .passage import LIGHTS
from .scene import REGIONS, LookIndex, SceneIndex
from .types import GLOW, SaidLink, SceneDescription

_MOST = 3  # words of a light's name
_AND = re.compile(r"(\s*\b(?:and|or|nor)\b\s*)")
_CLAUSE = re.compile(r"[,.;:!]|\b(?:and|but|with|while)\b")
_UNBOUND = "'{}': there is no {} '{}' in the scene; not used."


def without_links(text: str, scene: SceneDescription, vocabulary: Vocabulary) -> tuple[str, list[SaidLink], list[str]]:
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
                notes.append(_UNBOUND.format(quote, "light", noun))
            elif not objects:
                notes.append(_UNBOUND.format(quote, "object", match["what"].strip()))
            else:
                links.append(SaidLink(quote, pattern is not spares, objects, role, lights))
            bare = normalize(said).split()[: -len(noun.split())] in ([], ["the"])
            known = bare and (lights or not role)  # then these words ask for no light
            text = text[: start if known else match.start()].rstrip() + " , " + text[end:]
    return text, links[::-1], notes


def _linking(vocabulary: Vocabulary) -> list[re.Pattern[str]]:
    """Patterns of words that say what a light lights: only some objects, or by the last pattern, not some objects."""
    lights_only, only, spares = (any_of(vocabulary.words[kind]) for kind in ("lights_only", "only", "spares"))
    what, end = "(?P<what>[^,.;:!]+?)", r"(?=\s*(?:[,.;:!]|but\b|while\b|with\b|$))"
    texts = (rf"\b{lights_only} {what}{end}", rf"\bon {what} {only}{end}", rf"\b{spares} {what}{end}")
    return [re.compile(text, re.IGNORECASE) for text in texts]


def _light_noun(said: str, scene: SceneDescription, vocabulary: Vocabulary) -> str:
    """The name of a light at the end of words; "" if they name no particular light: "warm light"."""
    words = normalize(said).split()
    ends = [" ".join(words[-n:]) for n in range(min(_MOST, len(words)), 0, -1)]
    found = next((noun for noun in ends if any(_lights(noun, scene, vocabulary))), "")
    told = (noun for noun in ends[-1:] if vocabulary.nouns.get(noun) in LIGHTS and fixture(noun, vocabulary))
    return found or next(told, "")


def _lights(noun: str, scene: SceneDescription, vocabulary: Vocabulary) -> tuple[tuple[str, ...], str]:
    """The lights of the scene that a noun names, or the role of lights that it stands for."""
    alone = " ".join(word for word in noun.split() if word not in vocabulary.lists["anylight"])
    index = scene.made(SceneIndex, vocabulary)
    named = (n for said in dict.fromkeys((noun, alone)) if parts(said) for n in index.named(parts(said)))
    own = (n for n in named if n.kind == "lights" and any(sign.startswith("light ") for sign in n.signs))
    names = {name: None for n in own for name in sorted(n.names) if not name.startswith(GLOW)}
    kind = vocabulary.nouns.get(noun, "")
    role = next((vocabulary.roles[word] for word in noun.split() if word in vocabulary.roles), "")
    is_light = kind in LIGHTS and fixture(noun, vocabulary)
    return tuple(names), (kind if kind in ("fill", "rim") else role) if is_light else ""


def _objects(match: re.Match[str], scene: SceneDescription, vocabulary: Vocabulary) -> tuple[tuple[str, ...], int]:
    """The objects that nouns after a link name, and where the link ends: before "and warm fog"."""
    first, *others = _AND.split(match["what"])
    found, end = [*_called(first, scene, vocabulary)], match.start("what") + len(first)
    for joiner, noun in zip(others[::2], others[1::2], strict=True):
        named = _called(noun, scene, vocabulary)
        if not named:
            return tuple(found), end
        found, end = [*dict.fromkeys([*found, *named])], end + len(joiner) + len(noun)
    return tuple(found), match.end()


def _called(noun: str, scene: SceneDescription, vocabulary: Vocabulary) -> tuple[str, ...]:
    """The objects that a noun names: by their names, by the shape of their materials, or as subject or surroundings."""
    fillers = vocabulary.lists["stop"] | vocabulary.lists["definite"]
    noun = " ".join(word for word in normalize(noun).split() if word not in fillers)
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
