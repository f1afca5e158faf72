# SPDX-License-Identifier: Apache-2.0
"""The proxy beside Mitsuba 3, on the same scenes."""
