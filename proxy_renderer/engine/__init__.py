# SPDX-License-Identifier: Apache-2.0
"""The engine as a process: it answers Blender, runs vibes and reports on them."""
