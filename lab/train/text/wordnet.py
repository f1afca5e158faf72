# SPDX-License-Identifier: Apache-2.0
"""WordNet: which words there are, what they mean, and which of them may speak of a look."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Container, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from proxy_renderer.words.lexicon.entries import normalize
from proxy_renderer.words.lexicon.languages import KINDS

SENSES = 3
"""Of a word, the most frequent ones are looked at."""

_LOOKS = {
    "noun.substance", "noun.state", "noun.attribute", "noun.phenomenon", "noun.feeling", "noun.time",
    "adj.all", "adj.ppl", "adj.pert", "verb.weather",
}  # fmt: skip
_MATTER = (
    "fabric", "jewel", "metal", "wood", "stone", "light", "fire", "season", "time of day", "building material",
    "weather", "leather", "fur", "coating", "crockery", "ceramic", "sheet metal", "confection", "ice", "sea", "pavement",
)  # fmt: skip
_FILES = [
    "adj.all",
    "adj.pert",
    "adv.all",
    "noun.Tops",
    "noun.act",
    "noun.animal",
    "noun.artifact",
    "noun.attribute",
    "noun.body",
    "noun.cognition",
    "noun.communication",
    "noun.event",
    "noun.feeling",
    "noun.food",
    "noun.group",
    "noun.location",
    "noun.motive",
    "noun.object",
    "noun.person",
    "noun.phenomenon",
    "noun.plant",
    "noun.possession",
    "noun.process",
    "noun.quantity",
    "noun.relation",
    "noun.shape",
    "noun.state",
    "noun.substance",
    "noun.time",
    "verb.body",
    "verb.change",
    "verb.cognition",
    "verb.communication",
    "verb.competition",
    "verb.consumption",
    "verb.contact",
    "verb.creation",
    "verb.emotion",
    "verb.motion",
    "verb.perception",
    "verb.possession",
    "verb.social",
    "verb.stative",
    "verb.weather",
    "adj.ppl",
]


_NO_LOOKS = {
    "noun.person", "noun.animal", "noun.body", "noun.act", "noun.communication", "noun.group", "noun.plant", "noun.food",
}  # fmt: skip
_FREQUENT, _BESIDE = 60_000, "@+&\\="  # of the most frequent words, and pointers that lead to look words


@dataclass
class Synset:
    """One sense: its words, its gloss, its file ("noun.substance") and what it points to."""

    words: list[str]
    gloss: str
    file: str
    links: list[tuple[str, str]] = field(default_factory=list)  # pointer symbol, synset


@dataclass
class WordNet:
    """Synsets by part of speech and offset; word -> its senses, the most frequent first, with how often each is meant."""

    synsets: dict[str, Synset]
    senses: dict[str, list[tuple[str, float]]]


def read_wordnet(folder: Path) -> WordNet:
    """Reads data.* and index.sense (formats: wndb(5), senseidx(5))."""
    synsets: dict[str, Synset] = {}
    for part in ("adj", "noun", "verb", "adv"):
        for line in (folder / f"data.{part}").read_text("utf-8").splitlines():
            if not line.startswith("  "):
                key, synset = _synset(line)
                synsets[key] = synset
    senses: dict[str, list[tuple[str, float]]] = defaultdict(list)
    letters = {"1": "n", "2": "v", "3": "a", "4": "r", "5": "a"}
    for line in (folder / "index.sense").read_text("utf-8").splitlines():
        sense, offset, number, count = line.split()
        lemma, _, rest = sense.partition("%")
        weight = (float(count) + 0.5) / float(number)
        senses[_plain(lemma)].append((letters[rest[0]] + offset, weight))
    for word in senses:
        senses[word].sort(key=lambda pair: -pair[1])
    return WordNet(synsets, dict(senses))


def _synset(line: str) -> tuple[str, Synset]:
    data, _, gloss = line.partition(" | ")
    parts = data.split()
    offset, file, kind, count = parts[0], int(parts[1]), parts[2].replace("s", "a"), int(parts[3], 16)
    words = [_plain(w) for w in parts[4 : 4 + 2 * count : 2]]
    rest = parts[4 + 2 * count :]
    links = [(rest[1 + 4 * i], rest[3 + 4 * i].replace("s", "a") + rest[2 + 4 * i]) for i in range(int(rest[0]))]
    return kind + offset, Synset(words, gloss.split('; "')[0].strip(), _FILES[file], links)


def _plain(lemma: str) -> str:
    return normalize(lemma.split("(")[0].replace("_", " "))


def candidates(net: WordNet, common: Sequence[str], vocabulary: Container[str]) -> dict[str, int]:
    """The words that may speak of a look.

    Names of things are among them only where WordNet has look words beside them ("masonry": stonework).

    Args:
        net: Gets senses of verbs for common words that have none of their own ("scuffed").
        common: English words, the most frequent ones first.
        vocabulary: The look words that are listed.

    Returns:
        Word -> index into KINDS.
    """
    kinds = {}
    for word, senses in net.senses.items():
        if not word.replace(" ", "").isalpha() or len(word) < 3 or word.count(" ") > 1:
            continue
        files = [(net.synsets[key].file, weight) for key, weight in senses]
        total = sum(weight for _, weight in files)
        adjective = sum(w for f, w in files if f.startswith("adj")) / total
        looks = sum(w for f, w in files if f in _LOOKS) / total
        matter = any(_is_matter(net, key) for key, _ in senses[:SENSES])
        if " " in word and adjective < 0.5 and not matter:
            continue
        if adjective > 0.3:
            kinds[word] = KINDS.index("adjective")
        elif looks > 0.25 or matter:
            kinds[word] = KINDS.index("noun")
    for word in common:
        if word not in kinds and word.isalpha() and (verb := _verb(net, word)):
            net.senses.setdefault(word, [pair for pair in net.senses[verb] if pair[0][0] == "v"])
            kinds[word] = KINDS.index("adjective")
    for word in common[:_FREQUENT]:
        if word not in kinds and word.isalpha() and len(word) > 3 and _beside(net, word, vocabulary):
            kinds[word] = KINDS.index("noun")
    return kinds


def _beside(net: WordNet, word: str, looks: Container[str]) -> bool:
    """True if one of a word's first senses shares, derives from or is a kind of what a look word means."""
    for key, _ in net.senses.get(word, [])[:2]:
        synset = net.synsets[key]
        if synset.file.startswith("verb") or synset.file in _NO_LOOKS:
            continue
        linked = (net.synsets[target].words for symbol, target in synset.links if symbol in _BESIDE)
        if any(w in looks and w != word for words in (synset.words, *linked) for w in words):
            return True
    return False


def _verb(net: WordNet, word: str) -> str:
    """The verb that a participle is of: "scuffed" -> "scuff"; "" for none."""
    for ending in ("ed", "ing"):
        stem = word.removesuffix(ending)
        if stem == word or len(stem) < 3 or any(key[0] == "n" for key, _ in net.senses.get(word, [])[:1]):
            continue
        for verb in (stem, stem + "e", stem[:-1] if stem[-1] == stem[-2] else stem):
            if any(key[0] == "v" for key, _ in net.senses.get(verb, [])):
                return verb
    return ""


def _is_matter(net: WordNet, key: str, depth: int = 5) -> bool:
    """True if a sense is a kind of something that surfaces are made of, or that lights a scene."""
    synset = net.synsets[key]
    if set(synset.words) & set(_MATTER) or synset.file == "noun.substance":
        return True
    up = [target for symbol, target in synset.links if symbol == "@"]
    return depth > 0 and key[0] == "n" and any(_is_matter(net, target, depth - 1) for target in up)
