# SPDX-License-Identifier: Apache-2.0
"""The options of a vibe, and what is derived from them."""
