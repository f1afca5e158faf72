# SPDX-License-Identifier: Apache-2.0
"""The options of a vibe, their checks, and the command lines derived from them."""
