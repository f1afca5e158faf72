# SPDX-License-Identifier: Apache-2.0
"""Measures: what a look is on a picture. Each is differentiable in the picture, and knows no parameter of the scene."""
