# SPDX-License-Identifier: Apache-2.0
"""Many scenes, many prompts, many machines: `vibe batch`."""
