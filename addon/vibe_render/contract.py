# SPDX-License-Identifier: GPL-3.0-or-later
"""The schema, from wherever it is: copied into a built extension, beside the add-on in a clone."""

try:
    from . import schema  # type: ignore[attr-defined]
except ImportError:
    from proxy_renderer import schema

__all__ = ["schema"]
