# SPDX-License-Identifier: Apache-2.0
"""Gradients of outlines that move, of things and of shadows."""
