# SPDX-License-Identifier: Apache-2.0
"""Light as a gaffer sets it: which rig the words ask for, who plays its parts, where added lights stand, and how bright all are."""
