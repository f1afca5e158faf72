# SPDX-License-Identifier: Apache-2.0
"""The laboratory, which is not shipped.

Measurements (`bench`, and `blender`, their side in Blender), training (`train`), the encoder that only judges (`judge`), and
the methods that the product is compared with (`methods`).

`python -m lab NAME` in a clone measures; `python -m lab --help` lists all.
"""
