# SPDX-License-Identifier: Apache-2.0
"""Pictures that Cycles rendered, and what they teach the proxy."""
