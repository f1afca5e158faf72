# SPDX-License-Identifier: GPL-3.0-or-later
"""What Cycles renders for us: final pictures, anchors, baked passes."""
