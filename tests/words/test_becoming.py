# SPDX-License-Identifier: Apache-2.0
"""What words are at kinds of targets: their own sense where they have one, else that of [elsewhere], or of a part of a mood."""

import pytest

from proxy_renderer.words.lexer import Lexer, Token
from proxy_renderer.words.lexicon.vocabulary import shipped_vocabulary
from proxy_renderer.words.targets import sense_at
from proxy_renderer.words.types import SceneDescription

VOCABULARY = shipped_vocabulary()
_TARGETS = {"thing": "things", "lamp": "lights", "light": "light", "sky": "sky", "fog": "air", "tone": "picture"}


def token(word):
    (found,) = Lexer(VOCABULARY, SceneDescription()).clauses(word)[0]
    return found


def sense(word, kind):
    found = sense_at(token(word), kind, VOCABULARY)
    return found.entry if found else None


@pytest.mark.parametrize(
    ("word", "kind", "entry"),
    [
        ("dry", "things", "dry surface"),
        ("drier", "surroundings", "dry surface"),
        ("bleached", "things", "faded surface"),
        ("faded", "things", "faded surface"),
        ("loud", "things", "vivid surface"),
        ("calm", "lights", "weaker lamp"),
        ("cosy", "lights", "cosy lamp"),
        ("heavy", "sky", "lowering sky"),
        ("deeper", "things", "deeper surface"),
        ("old", "picture", "vintage"),
    ],
)
def test_words_have_senses_elsewhere(word, kind, entry):
    assert sense(word, kind) == entry


@pytest.mark.parametrize(
    ("word", "kind", "entry"),
    [
        ("warm", "lights", "warm light"),
        ("gold", "things", "gold"),
        ("dusty", "things", "dusty surface"),
        ("dark", "sky", "dark surroundings"),
        ("calm", "picture", "calm"),
    ],
)
def test_own_senses_come_first(word, kind, entry):
    assert sense(word, kind) == entry


@pytest.mark.parametrize("kind", VOCABULARY.elsewhere)
def test_every_row_is_of_use(kind):
    """By the word itself, by other ways to say the same, or in a mood that stands for it."""
    meant = " ".join(entry.means for entry in VOCABULARY.entries.values())
    for word, entry in VOCABULARY.elsewhere[kind].items():
        tokens = [Token(word, adjective=word if word in VOCABULARY.adjectives else "")]
        tokens += [Token(word, entry=word)] if word in VOCABULARY.entries else []
        found = [b.entry for t in tokens if (b := sense_at(t, _TARGETS[kind], VOCABULARY))]
        assert entry in found or word in meant, word
