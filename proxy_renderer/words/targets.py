# SPDX-License-Identifier: Apache-2.0
"""Targets that look words may describe; the sense of a word at a target ("gold" on a bowl is a metal); and choices."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ..schema import VibeError
from ..schema.targets import GENERAL, NAME_OF, NUMBER, joined, target_names
from .lexer import Token
from .lexicon.entries import OWNERS, normalize
from .lexicon.vocabulary import Vocabulary
from .names import is_detail
from .passage import Passage, PromptLook
from .scene import NounMention, taken
from .types import GLOW, Attribute, SceneDescription

MATTER = ("things", "subject", "surroundings", "others")  # kinds of targets that have a surface
ROLES = ("key", "fill", "rim")  # kinds of targets that are the lights of a role
LAMPS = ("lights", *ROLES)  # kinds of targets that are some of the lights
UNNAMED = ("subject", "surroundings", "light", "sky", "air", "picture", "none")
"""Kinds of targets that a prompt need not name."""
SURFACE = ("finish", "material", "color")  # slots of words about a surface
_OF_NOUNS = {
    "surroundings": "surroundings", "sky": "sky", "light": "light", "fill": "fill", "rim": "rim", "fog": "air",
    "shadow": "shadow", "highlight": "highlight", "tone": "picture", "glow": "light", "subject": "subject", "others": "others", "unknown": "subject",
}  # fmt: skip
"""Kind of noun -> kind of target."""
_KINDS = {
    "things": ("thing", "subject", "surroundings"), "subject": ("thing", "subject"), "surroundings": ("surroundings", "subject", "thing"),
    "others": ("thing", "subject", "surroundings"), "lights": ("lamp", "light"), "key": ("lamp", "light"),
    "fill": ("lamp", "fill", "light"), "rim": ("lamp", "rim", "light"), "light": ("light",), "shadow": ("shadow",), "highlight": ("highlight",),
    "sky": ("sky",), "air": ("fog",), "picture": ("tone",),
}  # fmt: skip
"""Kind of target -> kinds of things in the vocabulary's rows of adjectives; the first that a row has counts."""
_SLOTS = {
    "surroundings": ("setting",), "sky": ("setting", "lighting", "atmosphere"), "air": ("atmosphere",),
    "light": ("lighting",), "shadow": ("lighting", "grade"), "highlight": ("lighting", "grade", "finish"), "picture": ("lighting", "atmosphere", "grade", "mood", "setting"),
}  # fmt: skip
"""Kind of target -> slots of words that describe it; surfaces and particular lights have other rules."""
_NAMES = 8  # most names that the text of one target has
_TARGET_OF = {"light": "light", "fog": "air", "sky": "sky", "shadow": "shadow", "highlight": "highlight"}
"""Kind of thing -> kind of target, where that is not a region."""


@dataclass(frozen=True)
class Target:
    """A target: materials, lights or a part of the image that a look word may describe."""

    # "things", "lights", "shadow", "highlight", one of the labels of `UNNAMED`, "others", "key", "fill" or "rim"
    kind: str
    names: frozenset[str] = frozenset()  # of the materials or lights; empty where the kind says it all
    mention: int = -1  # place in `PromptPairs.mentions` of the noun that names it; -1 if none does
    signs: frozenset[str] = field(default=frozenset(), compare=False)  # how its names were found, see `scene.Named`

    def __str__(self) -> str:
        return f"{self.kind}: {' + '.join(sorted(self.names))}" if self.names else self.kind


@dataclass(frozen=True)
class Sense:
    """The sense of a look word at a target."""

    entry: str  # of the vocabulary; "" for the color that the word names
    slot: str  # of the entry
    way: str  # how it was found: "row" of the vocabulary's adjectives, "own" entry, "color", "otherwise", "elsewhere"


@dataclass(frozen=True)
class TargetPair:
    """A look word and one of the targets that it may describe."""

    look: PromptLook
    target: Target
    sense: Sense  # of the word at this target
    features: tuple[str, ...]  # facts about word and target, sorted: sums of weights are the same in every process
    chosen: str = ""  # name of the target if the artist has chosen it; "" if the reader has


@dataclass(frozen=True)
class PromptPairs:
    """A prompt before it is bound: `pairs` has a list for each look word in order, with all that it may describe."""

    passage: Passage
    mentions: list[NounMention]
    pairs: list[list[TargetPair]]


def targets(mentions: list[NounMention], words: SceneDescription) -> list[Target]:
    """All targets that look words of a prompt may have: those that need no noun, then those that its nouns name."""
    found = [Target(kind) for kind in UNNAMED]
    for number, mention in enumerate(mentions):
        found += (Target(named.kind, named.names, number, named.signs) for named in mention.named)
        if kind := mention.role or _OF_NOUNS.get(mention.noun, ""):
            lights = frozenset(name for name, light in words.lights.items() if light.role == kind)
            names = rest(mentions, words) if kind == "others" else lights
            found.append(Target(kind, names, number, frozenset({f"noun {mention.noun}"})))
        # Materials of a noun without those of other nouns: "the hut red, its roof black"
        others = [taken([m], words) for m in mentions if m.members == 1 and m is not mention]
        for named in (n for n in mention.named if n.kind == "things" and not mention.excepted):
            theirs = frozenset[str]().union(*(other for other in others if other < named.names))
            if theirs and named.names - theirs:
                signs = named.signs | {"without what else is named"}
                found.append(Target("things", named.names - theirs, number, signs))
    return found


def rest(
    mentions: list[NounMention], words: SceneDescription, described: frozenset[str] = frozenset()
) -> frozenset[str]:
    """All materials that a prompt neither names nor excepts, and that are not `described`.

    Materials of details are among them only if nothing else is left.
    """
    left = frozenset(words.materials) - taken(mentions, words) - described
    return frozenset(n for n in left if not is_detail(n)) or left


def sense_at(token: Token, kind: str, vocabulary: Vocabulary) -> Sense | None:
    """The sense of a word at a kind of target; None if the word cannot describe such a target."""
    if kind == "none":
        return Sense("", "", "own")
    rows = vocabulary.adjectives.get(token.adjective, {})
    senses = [("row", rows.get(k, "")) for k in _KINDS[kind]] + [("own", token.entry)]
    if kind == "picture" and token.entry and vocabulary.entries[token.entry].slot == "grade":
        senses.reverse()  # "dark" says more than "dark tones"
    if token.color:
        senses.append(("color", ""))
    senses.append(("otherwise", rows.get("otherwise", "")))
    elsewhere = [vocabulary.elsewhere.get(k, {}) for k in _KINDS[kind]]  # "a calm lamp"
    senses += [("elsewhere", row.get(word, "")) for word in (token.adjective, token.entry) for row in elsewhere]
    for way, entry in senses:
        if way == "color":
            return Sense("", "color", way)
        if entry and _describes(entry, kind, vocabulary):
            return Sense(entry, vocabulary.entries[entry].slot, way)
    return None


def _describes(entry: str, kind: str, vocabulary: Vocabulary) -> bool:
    slot = vocabulary.entries[entry].slot
    if kind in LAMPS:
        effects = vocabulary.entries[entry].effects
        return any(OWNERS[e.owner] == "light" and not e.weak for e in effects) and slot == "lighting"
    return (kind in MATTER and slot in SURFACE) or slot in _SLOTS.get(kind, ())


# Targets by their names: `--target copper=Cup`


def target_name(target: Target, scene: SceneDescription) -> str:
    """The name of a target, as `--target` takes it: "Cup + Lid", "image"; "" if it has none."""
    if target.names and target.kind not in ROLES:
        return _joined_names(target.names, scene, is_matter=target.kind in MATTER)
    return NAME_OF.get(target.kind, "")


def described_name(attribute: Attribute, scene: SceneDescription) -> str:
    """The name of what an attribute describes, as `--target` takes it: "Cup + Lid", "image"."""
    names = _joined_names(attribute.lights, scene, is_matter=False)
    names = names or _joined_names(attribute.owners, scene, is_matter=True)
    region = attribute.region if attribute.region in ("subject", "surroundings") else "picture"
    kind = attribute.role or _TARGET_OF.get(attribute.kind) or region
    return names or NAME_OF.get(kind, "lights" if attribute.role else "image")


def _joined_names(names: Collection[str], scene: SceneDescription, is_matter: bool) -> str:
    """Names of materials (`is_matter`) or lights, joined by " + "; "" for none or for more than `_NAMES`.

    Materials are named by the objects that wear no other materials, if these objects wear all of them.
    """
    if not is_matter:
        found = [name for name in scene.lights if name in names]
        found += [f"glow of {name}" for name in scene.glows if GLOW + name in names]
    else:
        objects = [o for o, worn in scene.object_materials.items() if worn and {*worn} <= {*names}]
        worn = {m for o in objects for m in scene.object_materials[o]}
        found = objects if worn == {*names} else [m for m in scene.materials if m in names]
    return joined(sorted(found)) if len(found) <= _NAMES else ""


def key_numbers(texts: Sequence[str]) -> list[str]:
    """The end of each look word's key: "#1", "#2" and so on for equal words, "" for a word that the prompt has once."""
    each = ((text, texts[: number + 1].count(text)) for number, text in enumerate(texts))
    return [f"{NUMBER}{count}" if texts.count(text) > 1 else "" for text, count in each]


def plain_key(key: str) -> str:
    """The word of a key without its number: "red" of "red#2"."""
    word, mark, number = key.rpartition(NUMBER)
    return word if mark and number.isdigit() else key


def with_choices(
    row: Sequence[TargetPair],
    choices: Mapping[str, str],
    english: Mapping[str, str],
    scene: SceneDescription,
    vocabulary: Vocabulary,
) -> tuple[list[TargetPair], list[str]]:
    """The pairs of `row`, with the artist's choices in place of the reader's; and words of choices without a look word.

    Raises VibeError if the scene has nothing with a chosen name, or if a word cannot describe its target.

    Args:
        choices: Word of the prompt -> a name in the scene, several with " + ", or one of `schema.targets.GENERAL`.
        english: Word of the prompt -> its English, if the prompt is in another language.
    """
    targets = {key: _target(plain_key(key), name, scene) for key, name in choices.items()}
    used, found = set[str](), list[TargetPair]()
    for number, pair in enumerate(row):
        same = sum(other.look.text == pair.look.text for other in row[: number + 1])
        for key in choices:
            word = plain_key(key)
            translated = normalize(english.get(word, ""))
            called = {normalize(word), translated, *translated.split()}
            numbered = key in (word, f"{word}{NUMBER}{same}")
            if not numbered or called.isdisjoint((pair.look.text, pair.look.token.text)):
                continue
            sense = sense_at(pair.look.token, targets[key].kind, vocabulary)
            if sense is None:
                problem = f"'{word}' can say nothing of {choices[key]!r}."
                raise VibeError(problem, "Choose another target, or 'not used'.")
            used.add(key)
            pair = TargetPair(pair.look, targets[key], sense, (), chosen=choices[key])
            break
        found.append(pair)
    return found, [plain_key(key) for key in choices if key not in used]


def _target(word: str, name: str, scene: SceneDescription) -> Target:
    """The target with a name, or with several that " + " joins. Raises VibeError, which names `word`, for others."""
    found = _named(name, scene)
    several = [_named(part, scene) for part in target_names(name)]
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


def _named(name: str, scene: SceneDescription) -> Target | None:
    """The target with a name in the scene, or with a general name such as "image"; None if nothing has that name.

    A name in the scene comes before a general one only if it has the same upper and lower case.
    """
    lower = name.casefold()
    own = {each: Target("lights", frozenset({each})) for each in scene.lights}
    own |= {f"glow of {each}": Target("lights", frozenset({GLOW + each})) for each in scene.glows}
    own |= {each: Target("things", frozenset({each})) for each in scene.materials}
    own |= {each: Target("things", frozenset(worn)) for each, worn in scene.object_materials.items()}
    kind = "" if name in own else GENERAL.get(lower, "")
    if kind:
        lights = (each for each, light in scene.lights.items() if light.role == kind)
        return Target(kind, frozenset(lights if kind in ROLES else ()))
    return own.get(name) or next((target for each, target in own.items() if each.casefold() == lower), None)
