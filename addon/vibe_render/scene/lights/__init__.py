# SPDX-License-Identifier: GPL-3.0-or-later
"""Light types: one module for each of Blender's, all behind the protocol in `light_type`, listed once in `registry`."""
