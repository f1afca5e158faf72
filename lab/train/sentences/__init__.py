# SPDX-License-Identifier: Apache-2.0
"""Sentences whose look words are labeled with what they describe, and the scenes that they are about."""

from lab.train.sentences.folder import read_folder as read_folder
