# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees: where a value really is, and the node groups that Vibe Render adds."""
