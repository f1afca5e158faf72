# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees: finds the socket that holds a value, and builds the node groups that Vibe Render adds."""
