# SPDX-License-Identifier: Apache-2.0
"""Checks of files, words and options that people hand in; a mistake is refused with the remedy."""
