# SPDX-License-Identifier: Apache-2.0
"""Cameras, rays, and which points of the image are shaded. No light in here."""
