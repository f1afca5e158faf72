# SPDX-License-Identifier: Apache-2.0
"""The exported scene as the engine sees it."""

from .data import Camera, FilmSettings, Light, Material, Mesh, SceneData, SceneObject, Texture, Volume, World
from .load import load_scene

__all__ = [
    "Camera",
    "FilmSettings",
    "Light",
    "Material",
    "Mesh",
    "SceneData",
    "SceneObject",
    "Texture",
    "Volume",
    "World",
    "load_scene",
]
