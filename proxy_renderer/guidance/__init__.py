# SPDX-License-Identifier: Apache-2.0
"""The judge of a picture against words: the encoder, its views of a picture, and the objective."""
