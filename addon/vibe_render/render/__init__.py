# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders by Cycles: final renders, anchors, light layers, bakes of node networks."""
