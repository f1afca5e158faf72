# SPDX-License-Identifier: Apache-2.0
"""What people hand in: files, words, and how they are to be used; found good, or refused with the remedy."""
