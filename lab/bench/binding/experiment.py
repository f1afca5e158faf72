# SPDX-License-Identifier: Apache-2.0
"""Reads every labeled sentence of a folder with the real reader and the real assignment of lights, and compares.

Nothing is rendered, and no Blender is needed. Sentences are printed only if they are asked for: those that are held out
stay unread.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from lab.bench.binding import explaining, table
from lab.bench.binding.captions import measure
from lab.bench.binding.judge import judge
from lab.bench.binding.reading import SentenceReading, read
from lab.train import binding
from lab.train.sentences import read_folder
from lab.train.sentences.labels import SENTENCE_KINDS, LabeledSentence
from proxy_renderer.schema import VibeError, atomic
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary


def run(
    out: Path, sentences: str = "", captions: str = "", kind: str = "", misses: bool = False, folds: int = 0
) -> dict[str, Any]:
    """Measures, prints the tables, and writes OUT/results.json.

    Args:
        sentences: Folder of scenes.toml and sentences_NN.toml; "" for captions.
        captions: File of captions by others instead.
        kind: Only sentences of this kind; "" for all.
        misses: Print each mistaken sentence, and write it into results.json.
        folds: Parts into which the scenes are divided; the sentences of each are read with weights that are fitted to
            those of the others. 0 for the weights that are shipped.

    Returns:
        The content of results.json, see `table.summary`, and `explaining`, see there; or see `captions.measure`.

    Raises:
        VibeError: The folder or file is not of the format, or has no such sentence; captions with `kind` or `folds`.
    """
    if captions and (kind or folds):
        raise VibeError("Captions have no kinds and no scenes of their own.", "Leave out --kind and --folds.")
    if captions:
        return measure(out, captions, misses)
    every = read_folder(Path(sentences))
    labeled = [s for s in every if kind in ("", s.kind)]
    if not labeled:
        raise VibeError(f"No sentence is of the kind '{kind}'.", f"Use one of: {', '.join(SENTENCE_KINDS)}.")
    vocabulary = shipped_vocabulary()
    weights = binding.fit(binding.examples(every, vocabulary), folds=folds).without if folds else {}

    def reading(s: LabeledSentence) -> SentenceReading:
        return read(s.text, s.scene, vocabulary, weights.get(s.scene.name))

    reading(labeled[0])  # word vectors are loaded once
    verdicts = [judge(s, reading(s), vocabulary) for s in labeled]
    results = {**table.summary(verdicts), "explaining": explaining.measured(labeled)}
    results |= {"misses": table.missed(verdicts)} if misses else {}
    atomic.write_text(out / "results.json", json.dumps(results, indent=1, ensure_ascii=False))
    table.show(results)
    return results
