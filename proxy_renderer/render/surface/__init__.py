# SPDX-License-Identifier: Apache-2.0
"""Light from surfaces to the camera: the Principled BSDF, direct light, edges, and the caches of one view."""
