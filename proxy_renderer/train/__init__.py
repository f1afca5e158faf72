# SPDX-License-Identifier: Apache-2.0
"""Where the embedded encoder is made: shapes → traced views → shaded looks → captions → training.

``python -m proxy_renderer.train --help`` lists the steps.
"""
