# SPDX-License-Identifier: Apache-2.0
"""Claims: how the image has to look by the words, as intervals of measures, and whether it does."""
