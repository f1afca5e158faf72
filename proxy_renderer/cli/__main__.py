# SPDX-License-Identifier: Apache-2.0
"""`python -m proxy_renderer.cli` is the command `vibe`."""

import sys

from .main import main

sys.exit(main())
