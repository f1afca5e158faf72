# SPDX-License-Identifier: Apache-2.0
"""Picture files of every kind, as sRGB or as linear Rec.709; or one line that says why not."""
