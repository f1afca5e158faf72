# SPDX-License-Identifier: Apache-2.0
"""What commands take, and what can be wrong with it."""
