# SPDX-License-Identifier: Apache-2.0
"""Targets by their names, and the targets that an artist has chosen: `--target copper=Cup`, `Cup: copper`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from ..schema import VibeError
from ..schema.targets import GENERAL, NAME_OF, NUMBER, joined, parted
from .lexicon.entries import normalize
from .lexicon.vocabulary import Vocabulary
from .targets import MATTER, ROLES, Target, TargetPair, sense_at
from .types import GLOW, Attribute, SceneWords

_NAMES = 8  # names of one target: more are not worth reading
_KINDS = {"light": "light", "fog": "air", "sky": "sky", "shadow": "shadow", "highlight": "highlight"}
"""Kind of thing -> kind of target, where that is not a region."""


def target_name(target: Target, scene: SceneWords) -> str:
    """The name of something that a word may describe; "" where it has none."""
    if target.names and target.kind not in ROLES:
        return _joined_names(target.names, scene, is_matter=target.kind in MATTER)
    return NAME_OF.get(target.kind, "")


def described_name(attribute: Attribute, scene: SceneWords) -> str:
    """The name of what an attribute describes."""
    names = _joined_names(attribute.lights, scene, is_matter=False) if attribute.lights else ""
    names = names or (_joined_names(attribute.owners, scene, is_matter=True) if attribute.owners else "")
    region = attribute.region if attribute.region in ("subject", "surroundings") else "picture"
    kind = attribute.role or _KINDS.get(attribute.kind) or region
    return names or NAME_OF.get(kind, "lights" if attribute.role else "image")


def _glow_name(material: str) -> str:
    return f"glow of {material}"


def _joined_names(names: Collection[str], scene: SceneWords, is_matter: bool) -> str:
    """Lights by their names; materials by the objects that wear nothing else, as far as these wear all of them."""
    if not is_matter:
        found = [name for name in scene.lights if name in names]
        found += [_glow_name(name) for name in scene.glows if GLOW + name in names]
    else:
        objects = [o for o, worn in scene.object_materials.items() if worn and {*worn} <= {*names}]
        worn = {m for o in objects for m in scene.object_materials[o]}
        found = objects if worn == {*names} else [m for m in scene.materials if m in names]
    return joined(sorted(found)) if len(found) <= _NAMES else ""


def key_numbers(texts: Sequence[str]) -> list[str]:
    """Ends of the keys of look words: "#2" for the second of equal ones, "" where the prompt says it once.

    Args:
        texts: Of all look words of a prompt, in English.
    """
    each = ((text, texts[: number + 1].count(text)) for number, text in enumerate(texts))
    return [f"{NUMBER}{count}" if texts.count(text) > 1 else "" for text, count in each]


def plain_key(key: str) -> str:
    """The word of a key without its number: "red" of "red#2"."""
    word, mark, number = key.rpartition(NUMBER)
    return word if mark and number.isdigit() else key


@dataclass(frozen=True)
class _Choice:
    """A word with the target that an artist has chosen.

    Attributes:
        word: As the artist wrote it.
        known: The words in English by which the reader may know it, normalized.
        number: Which of several equal words of the prompt; 0 for all of them.
        name: Of the target.
        target: The target in the scene.
    """

    word: str
    known: frozenset[str]
    number: int
    name: str
    target: Target


class Choices:
    """The targets that an artist has chosen for words.

    Args:
        chosen: Word of the prompt -> a name in the scene, several with " + ", or one of `schema.targets.GENERAL`.
        english: Word of the prompt -> the same in English, where the prompt is in another language.
        keyed: Number of a look word -> the name in the scene that the prompt itself sets before it: "Cup: copper".

    Raises:
        VibeError: The scene has nothing of such a name.
    """

    def __init__(
        self,
        chosen: Mapping[str, str],
        english: Mapping[str, str],
        keyed: Mapping[int, str],
        scene: SceneWords,
        vocabulary: Vocabulary,
    ) -> None:
        self._vocabulary, self._scene, self._keyed = vocabulary, scene, keyed
        self._choices = []
        for key, name in chosen.items():
            word = plain_key(key)
            translated = normalize(english.get(word, ""))
            known = frozenset({normalize(word), translated, *translated.split()} - {""})
            number = int(key[len(word) + 1 :] or 0)
            self._choices.append(_Choice(word, known, number, name, _target(word, name, scene)))
        self._used: set[str] = set()

    def bound(self, pairs: Iterable[TargetPair]) -> list[TargetPair]:
        """Look words with the targets that were chosen for them, or else as the reader takes them.

        Raises:
            VibeError: A word can say nothing of its target.
        """
        counts: Counter[str] = Counter()
        found = []
        for number, pair in enumerate(pairs):
            counts[pair.look.text] += 1
            texts, count = {pair.look.text, pair.look.token.text}, counts[pair.look.text]
            fitting = (c for c in self._choices if c.number in (0, count) and not texts.isdisjoint(c.known))
            if choice := next(fitting, None):
                self._used.add(choice.word)
                means = sense_at(pair.look.token, choice.target.kind, self._vocabulary)
                if means is None:
                    raise VibeError(
                        f"'{choice.word}' can say nothing of {choice.name!r}.",
                        "Choose another target, or 'not used'.",
                    )
                pair = TargetPair(pair.look, choice.target, means, (), chosen=choice.name)
            elif name := self._keyed.get(number, ""):
                target = _target(pair.look.text, name, self._scene)
                means = sense_at(pair.look.token, target.kind, self._vocabulary)
                pair = TargetPair(pair.look, target, means, (), chosen=name) if means else pair
            found.append(pair)
        return found

    def unused(self) -> list[str]:
        """Words with a choice that are no look words of the prompt."""
        return [choice.word for choice in self._choices if choice.word not in self._used]


def _target(word: str, name: str, scene: SceneWords) -> Target:
    """The target of a name in a scene, or of several names that " + " joins."""
    found = _named(name, scene)
    several = [_named(part, scene) for part in parted(name)]
    if found is None and all(several):
        targets = [target for target in several if target]
        if len({target.kind for target in targets}) == 1 and all(target.names for target in targets):
            found = replace(targets[0], names=frozenset().union(*(target.names for target in targets)))
    if found is None:
        raise VibeError(
            f"'{name}', which '{word}' is to describe, is no object, material or light of the scene.",
            f"Use a name in the scene, several with{joined(['', ''])}between them, or one of: {', '.join(GENERAL)}.",
        )
    return found


def _named(name: str, scene: SceneWords) -> Target | None:
    """Something of the scene, or what every scene has; upper and lower case count only between these."""
    own = {each: Target("lights", frozenset({each})) for each in scene.lights}
    own |= {_glow_name(each): Target("lights", frozenset({GLOW + each})) for each in scene.glows}
    own |= {each: Target("things", frozenset({each})) for each in scene.materials}
    own |= {each: Target("things", frozenset(worn)) for each, worn in scene.object_materials.items()}
    lower = name.casefold()
    kind = "" if name in own else GENERAL.get(lower, "")
    if kind in ROLES:
        return Target(kind, frozenset(n for n, light in scene.lights.items() if light.role == kind))
    if kind:
        return Target(kind)
    return own.get(name) or next((target for each, target in own.items() if each.casefold() == lower), None)
