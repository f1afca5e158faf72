# SPDX-License-Identifier: Apache-2.0
"""Reading: from a sentence to bound attributes."""
