# SPDX-License-Identifier: Apache-2.0
"""Color: spaces, differences, blackbody light and the view transform, of plain floats, numpy arrays and torch tensors."""
