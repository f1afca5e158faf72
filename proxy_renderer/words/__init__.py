# SPDX-License-Identifier: Apache-2.0
"""What the words mean, and of what: from a sentence to bound attributes."""
