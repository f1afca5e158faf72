# SPDX-License-Identifier: Apache-2.0
"""Materials of surfaces: shading inputs, textures, albedos of microfacets."""
