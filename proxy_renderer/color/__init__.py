# SPDX-License-Identifier: Apache-2.0
"""Color: spaces, differences, blackbody light and the view transform.

`constants` has every number once; `floats`, `arrays` and `tensors` are the same conversions for plain floats, numpy and torch.
"""
