# SPDX-License-Identifier: Apache-2.0
"""No test asks the vision-language model that its reader may have configured."""

import os

os.environ.pop("VIBE_VLM_MODEL", None)
