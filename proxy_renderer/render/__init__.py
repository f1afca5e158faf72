# SPDX-License-Identifier: Apache-2.0
"""The proxy renderer: what Cycles would show, differentiable, in torch."""
