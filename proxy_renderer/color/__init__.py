# SPDX-License-Identifier: Apache-2.0
"""Color mathematics and the view transform."""
