# SPDX-License-Identifier: Apache-2.0
"""Claims: what the words say that the picture has to look like, and whether it does."""
