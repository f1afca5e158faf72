# SPDX-License-Identifier: Apache-2.0
"""Light on its way: fog, indirect light, what is seen through glass."""
