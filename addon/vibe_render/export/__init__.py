# SPDX-License-Identifier: GPL-3.0-or-later
"""Exports a scene to a job folder, which the engine reads: meshes, materials, camera, lights, film and world."""
