# SPDX-License-Identifier: Apache-2.0
"""Color: spaces, differences, blackbody light and the view transform.

`constants` has every number once. `floats`, `arrays` and `tensors` convert plain floats, numpy arrays and torch tensors.
"""
