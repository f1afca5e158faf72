# SPDX-License-Identifier: Apache-2.0
"""Checks of the files, words and options that users give; an error names the remedy."""
