# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders by Cycles: final pictures, anchors, bakes of node networks."""
