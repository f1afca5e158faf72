# SPDX-License-Identifier: Apache-2.0
"""The fitted reader: each look word with each target that it may have, features of the pair, a score, one assignment."""
