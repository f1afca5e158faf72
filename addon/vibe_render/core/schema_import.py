# SPDX-License-Identifier: GPL-3.0-or-later
"""The schema, from wherever it is: copied into a built extension, beside the add-on in a clone."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from proxy_renderer import schema
    from proxy_renderer.schema import labels, messages, preset
else:
    try:
        from .. import schema
        from ..schema import labels, messages, preset
    except ImportError:
        from proxy_renderer import schema
        from proxy_renderer.schema import labels, messages, preset

__all__ = ["labels", "messages", "preset", "schema"]
