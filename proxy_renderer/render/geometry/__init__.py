# SPDX-License-Identifier: Apache-2.0
"""Cameras, rays, and which points of the picture are shaded. No light in here."""
