# SPDX-License-Identifier: Apache-2.0
"""The manifest of `vibe batch`: read, checked, its files found."""
