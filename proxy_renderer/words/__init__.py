# SPDX-License-Identifier: Apache-2.0
"""Reads a prompt: from its text to attributes, which are look words bound to what they describe."""
