# SPDX-License-Identifier: Apache-2.0
"""A reference image, with or without words: claims about its look, and the values that may change for them."""
