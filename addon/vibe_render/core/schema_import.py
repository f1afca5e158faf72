# SPDX-License-Identifier: GPL-3.0-or-later
"""Schema import: from the copy inside a built extension, or from the engine's package in a clone."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from proxy_renderer import schema
    from proxy_renderer.schema import atomic, errors, labels, limits, messages, preset, sentences, targets
    from proxy_renderer.schema.options import checks, command_line
    from proxy_renderer.schema.options import table as options
else:
    try:
        from .. import schema
        from ..schema import atomic, errors, labels, limits, messages, preset, sentences, targets
        from ..schema.options import checks, command_line
        from ..schema.options import table as options
    except ImportError:
        from proxy_renderer import schema
        from proxy_renderer.schema import atomic, errors, labels, limits, messages, preset, sentences, targets
        from proxy_renderer.schema.options import checks, command_line
        from proxy_renderer.schema.options import table as options
