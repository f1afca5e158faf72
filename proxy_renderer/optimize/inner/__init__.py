# SPDX-License-Identifier: Apache-2.0
"""The inner loop (Algorithm 1, lines 8 to 15): least squares on what the words claim, or the paper's Adam."""
