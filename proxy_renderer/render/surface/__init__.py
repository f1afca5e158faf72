# SPDX-License-Identifier: Apache-2.0
"""What surfaces send to the camera: the Principled BSDF, and the caches of one view."""
