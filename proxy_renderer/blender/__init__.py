# SPDX-License-Identifier: Apache-2.0
"""Blender as the engine's side sees it: started, followed, and given our extension."""
