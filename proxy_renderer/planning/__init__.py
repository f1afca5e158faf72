# SPDX-License-Identifier: Apache-2.0
"""From bound words to ranges, priorities and reasons."""
