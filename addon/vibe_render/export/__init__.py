# SPDX-License-Identifier: GPL-3.0-or-later
"""The scene as the engine's job: materials, textures, camera, lights, film and world, as files."""
