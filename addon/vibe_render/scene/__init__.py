# SPDX-License-Identifier: GPL-3.0-or-later
"""What a .blend holds, and how values get in and out of it."""
