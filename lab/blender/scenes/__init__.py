# SPDX-License-Identifier: GPL-3.0-or-later
"""The measured scenes: recipes, subjects, surfaces, and their builders."""
