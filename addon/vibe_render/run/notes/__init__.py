# SPDX-License-Identifier: GPL-3.0-or-later
"""What a vibe made of words, claims and a model, in lines for people."""
