# SPDX-License-Identifier: Apache-2.0
"""What sends light: lamps, suns, the world, glowing surfaces, and their shadows."""
