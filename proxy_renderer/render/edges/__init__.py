# SPDX-License-Identifier: Apache-2.0
"""Gradients of moving discontinuities: silhouettes and shadow edges."""
