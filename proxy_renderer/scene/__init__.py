# SPDX-License-Identifier: Apache-2.0
"""The exported scene as the engine sees it."""

from .data import (
    Camera,
    FilmSettings,
    FogBounds,
    Light,
    Material,
    MeshObject,
    SceneData,
    SceneMesh,
    Standby,
    Texture,
    WorldData,
)
from .load import load_scene

__all__ = [
    "Camera", "FilmSettings", "FogBounds", "Light", "Material", "MeshObject", "SceneData", "SceneMesh", "Standby",
    "Texture", "WorldData", "load_scene",
]  # fmt: skip
