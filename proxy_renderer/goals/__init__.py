# SPDX-License-Identifier: Apache-2.0
"""Goals for the image: wishes, and the one that wins a conflict."""
