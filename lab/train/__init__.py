# SPDX-License-Identifier: Apache-2.0
"""The making of the embedded encoder: shapes → traced views → shaded looks → captions → training.

``python -m lab train --help`` lists the steps; ``python -m lab fit`` fits the weights of the reader, ``python -m lab words`` makes
its table of words.
"""
