# SPDX-License-Identifier: GPL-3.0-or-later
"""The contents of a .blend, and how values get in and out of it."""
