# SPDX-License-Identifier: Apache-2.0
"""Prompts in other languages: a lexicon for each puts English look words in place of the artist's, word by word."""
