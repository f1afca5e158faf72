# SPDX-License-Identifier: GPL-3.0-or-later
"""Schema import: from the copy inside a built extension, or from the engine's package in a clone."""

from importlib.util import find_spec
from typing import TYPE_CHECKING

from . import ADDON

if TYPE_CHECKING or find_spec(f"{ADDON}.schema") is None:
    from proxy_renderer import schema
    from proxy_renderer.schema import atomic, errors, labels, limits, messages, preset, sentences, targets
    from proxy_renderer.schema.options import checks
    from proxy_renderer.schema.options import table as options
else:
    from .. import schema
    from ..schema import atomic, errors, labels, limits, messages, preset, sentences, targets
    from ..schema.options import checks
    from ..schema.options import table as options
