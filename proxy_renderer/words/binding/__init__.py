# SPDX-License-Identifier: Apache-2.0
"""What look words describe: each look word with each target that it may have, features of the pair, a score, one assignment."""
