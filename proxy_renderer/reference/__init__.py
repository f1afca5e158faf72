# SPDX-License-Identifier: Apache-2.0
"""A reference image, in place of words or with them: its look as claims, and the values that may change for it."""
