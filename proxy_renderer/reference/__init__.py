# SPDX-License-Identifier: Apache-2.0
"""A picture as the words: what it looks like, as claims, and what may change to get there."""
