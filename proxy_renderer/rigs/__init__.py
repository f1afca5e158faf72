# SPDX-License-Identifier: Apache-2.0
"""Lighting rigs as gaffers set them up: the rig that words ask for, the lights of its parts, their places and power."""
