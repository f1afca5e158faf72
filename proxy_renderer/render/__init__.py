# SPDX-License-Identifier: Apache-2.0
"""The proxy renderer: a differentiable approximation of Cycles, in torch."""
