# SPDX-License-Identifier: GPL-3.0-or-later
"""The measured scenes: recipes, subjects and surfaces, and what builds them."""
