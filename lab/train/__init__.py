# SPDX-License-Identifier: Apache-2.0
"""Where the embedded encoder is made: shapes → traced views → shaded looks → captions → training.

``python -m lab train --help`` lists the steps; ``python -m lab fit`` fits the weights of the reader, ``python -m lab words`` makes
its table of words.
"""
