# SPDX-License-Identifier: Apache-2.0
"""Blender from outside: starts it, follows its progress, and installs the extension."""
