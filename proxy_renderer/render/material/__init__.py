# SPDX-License-Identifier: Apache-2.0
"""What surfaces are made of: shading inputs, textures, microfacets."""
