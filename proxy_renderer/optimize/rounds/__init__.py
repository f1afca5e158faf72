# SPDX-License-Identifier: Apache-2.0
"""The rounds of Algorithm 1: starts, confinement, the choice of parameters, and how one round follows another."""
