# SPDX-License-Identifier: Apache-2.0
"""What a prompt is made of: its look words, and the places where it names something of the scene."""
