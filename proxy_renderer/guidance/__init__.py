# SPDX-License-Identifier: Apache-2.0
"""Compares an image with words: the encoder, its views of an image, and the objective."""
