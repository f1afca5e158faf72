# SPDX-License-Identifier: Apache-2.0
"""The lights that a prompt tells apart."""
