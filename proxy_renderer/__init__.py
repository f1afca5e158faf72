# SPDX-License-Identifier: Apache-2.0
"""Vibe Render's engine: a differentiable proxy renderer and the loop that guides it.

Importing this package is cheap and pulls in neither torch nor bpy.
"""

__version__ = "0.2.0"
