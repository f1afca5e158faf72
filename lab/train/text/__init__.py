# SPDX-License-Identifier: Apache-2.0
"""Training sentences: captions, wordings, word vectors."""
